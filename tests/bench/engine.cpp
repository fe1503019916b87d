// SPDX-License-Identifier: MIT
// What a period costs the audio thread while 64 strokes sound on 64 channels: the mean, and the worst.
#include <algorithm>
#include <ctime>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "engine/audio_loop.hpp"
#include "engine/feeder.hpp"
#include "pieces.hpp"

using namespace tactor;

namespace {

/// Takes everything at once and keeps nothing.
class nowhere : public sink {
public:
    explicit nowhere(unsigned period)
    {
        setup_.name = "nowhere";
        setup_.channels = 64;
        setup_.rate = 48000;
        setup_.format = sample_format::s32;
        setup_.period_frames = period;
        setup_.buffer_frames = 3 * period;
    }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_status prepare() noexcept override { return io_status::ok; }
    io_status start() noexcept override { return io_status::ok; }
    io_status resume() noexcept override { return io_status::ok; }
    std::size_t max_descriptors() const noexcept override { return 0; }
    std::size_t descriptors(std::span<pollfd>) noexcept override { return 0; }
    io_status ready(std::span<pollfd>) noexcept override { return io_status::ok; }
    io_result room() noexcept override { return {io_status::ok, setup_.period_frames, 0}; }
    io_result write(const std::byte* data, std::size_t frames) noexcept override
    {
        benchmark::DoNotOptimize(data);
        written_ += frames;
        return {io_status::ok, frames, 0};
    }
    stream_position position() noexcept override
    {
        const auto played = written_ - std::min<std::uint64_t>(written_, 2 * setup_.period_frames);
        return {written_, played, static_cast<std::int64_t>(played) * 20833, true};
    }
    void drop() noexcept override {}

private:
    stream_setup setup_;
    std::uint64_t written_ = 0;
};

void submit(engine::feeder& feed, engine::link& link, stroke_id& id, const std::vector<score>& strokes)
{
    for (const score& s : strokes)
        feed.submit(++id, s, link.status.load().written + 4800);
}

// The thread's own time: what others do with the processor is not the engine's cost.
double cpu_s() noexcept
{
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// One step of the audio thread is one period.
void periods(benchmark::State& state)
{
    const auto period = static_cast<unsigned>(state.range(0));
    static const std::vector<score> strokes = bench::strokes_64();
    nowhere out(period);
    engine::link link;
    engine::feeder feed(link, 24'000);
    engine::audio_loop loop(out, link, std::vector<double>(64, 1.0), {});
    loop.start(0);
    stroke_id id = 0;
    std::size_t ended = 64;
    double worst = 0.0;
    for (auto _ : state) {
        engine::report r;
        while (link.reports.pop(r))
            feed.handle(r);
        ended += feed.take_reports().size();
        if (ended >= 64) {
            ended = 0;
            submit(feed, link, id, strokes);
        }
        feed.pump(link.status.load().written, link.clock.load());
        const double from = cpu_s();
        loop.step(io_status::ok, 0);
        const double took = cpu_s() - from;
        state.SetIterationTime(took);
        worst = std::max(worst, took);
    }
    state.counters["worst_us"] = worst * 1e6;
    state.counters["period_us"] = period * 1e6 / 48000;
}
BENCHMARK(periods)
    ->Name("engine/64_strokes_on_64_channels")
    ->Arg(48)
    ->Arg(96)
    ->Arg(480)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

} // namespace
