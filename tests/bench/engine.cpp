// SPDX-License-Identifier: MIT
// Cost of a period for the audio thread while many strokes sound: the mean, and the worst; and how long a
// live point takes to the period in which it sounds.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <tactor/sink.hpp>

#include "engine/audio/audio_loop.hpp"
#include "engine/control/feeder.hpp"
#include "engine/live.hpp"
#include "pieces.hpp"
#include "synth/limits/guard.hpp"

using namespace tactor;

namespace {

/// A sink that takes everything at once; it keeps the period written last.
class nowhere : public sink {
public:
    nowhere(unsigned channels, unsigned period)
        : setup_{.name = "nowhere",
                 .channels = channels,
                 .rate = 48000,
                 .format = format_kind::s32,
                 .period_frames = period,
                 .buffer_frames = 3 * period},
          last_(period * setup_.frame_bytes())
    {
    }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override { return io_kind::ok; }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }
    std::size_t max_descriptors() const noexcept override { return 0; }
    std::size_t descriptors(std::span<pollfd>) noexcept override { return 0; }
    io_kind ready(std::span<pollfd>) noexcept override { return io_kind::ok; }
    io_result available() noexcept override { return {io_kind::ok, setup_.period_frames, 0}; }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        std::memcpy(last_.data(), frames.data(), frames.size());
        const std::size_t n = frames.size() / setup_.frame_bytes();
        written_ += n;
        return {io_kind::ok, n, 0};
    }
    stream_position position() noexcept override
    {
        const auto played = written_ - std::min<std::uint64_t>(written_, 2 * setup_.period_frames);
        return {written_, played, static_cast<std::int64_t>(played) * 20833, true};
    }
    void drop() noexcept override {}

    const std::vector<std::byte>& last() const noexcept { return last_; }

private:
    stream_setup setup_;
    std::vector<std::byte> last_;
    std::uint64_t written_ = 0;
};

/// An audio loop and its control side, in one thread.
struct stream {
    stream(unsigned channels, unsigned period, const engine::loop_options& o = {})
        : out(channels, period), loop(out, link, std::vector<double>(channels, 1.0), o)
    {
        loop.start(0);
    }
    void pump() { feed.pump(link.status.load().written, link.clock.load()); }

    /// Makes a step of the audio thread, a period, which is the time of an iteration.
    void measure_step(benchmark::State& state)
    {
        const double from = bench::cpu_s();
        loop.step(io_kind::ok, 0);
        const double took = bench::cpu_s() - from;
        state.SetIterationTime(took);
        worst = std::max(worst, took);
        total += took;
    }

    nowhere out;
    engine::link link;
    engine::feeder feed{link, 24'000};
    engine::audio_loop loop;
    double worst = 0.0;
    double total = 0.0;
};

std::vector<score> scores(algorithm_kind method)
{
    const array a = bench::square(64);
    std::vector<score> all;
    for (const plan& p : bench::strokes(a, 64, method))
        all.emplace_back(a, std::vector<placed_plan>{{p, {}}}, bench::levels(64));
    return all;
}

/// Measures a step of the audio thread, a period. The control thread feeds it; counts the periods in which it
/// had to wake up, and its time.
void periods(benchmark::State& state, algorithm_kind method, double power_dbfs)
{
    const auto period = static_cast<unsigned>(state.range(0));
    const std::vector<score> strokes = scores(method);
    engine::loop_options o;
    o.guards = synth::make_guards({.power_dbfs = power_dbfs}, 48000);
    stream s(64, period, o);
    stroke_id id = {};
    std::size_t ended = 64;
    double feeding = 0.0;
    std::uint64_t wakes = 0;
    for (auto _ : state) {
        const double begun = bench::cpu_s();
        wakes += s.link.to_control.consume() > 0 ? 1 : 0;
        engine::report r;
        while (s.link.reports.pop(r))
            s.feed.handle(r);
        ended += std::exchange(s.feed.reports(), {}).size();
        s.feed.beginnings().clear();
        if (ended >= 64) {
            ended = 0;
            for (const score& one : strokes)
                s.feed.submit({++id.number}, one, start_at::frame(s.link.status.load().written + 4800));
        }
        s.pump();
        feeding += bench::cpu_s() - begun;
        s.measure_step(state);
    }
    const double period_s = period / 48000.0;
    state.counters["worst_us"] = s.worst * 1e6;
    state.counters["worst_%_of_a_core"] = 100.0 * s.worst / period_s;
    const auto all = static_cast<double>(state.iterations());
    state.counters["mean_%_of_a_core"] = 100.0 * s.total / (all * period_s);
    state.counters["feeding_%_of_a_core"] = 100.0 * feeding / (all * period_s);
    state.counters["wakes_a_period"] = static_cast<double>(wakes) / all;
}
BENCHMARK_CAPTURE(periods, within_limits, algorithm_kind::park2016, drive_limits{}.power_dbfs)
    ->Name("engine/64_strokes_on_64_channels")
    ->Arg(48)
    ->Arg(96)
    ->Arg(480)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(periods, continuous, algorithm_kind::continuous, drive_limits{}.power_dbfs)
    ->Name("engine/64_continuous_on_64_channels")
    ->Arg(48)
    ->Arg(96)
    ->Arg(480)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
// 64 carriers, each of which counts separately.
BENCHMARK_CAPTURE(periods, held_down, algorithm_kind::park2016, -40.0)
    ->Name("engine/64_strokes_held_down")
    ->Arg(96)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

bool sounds(const nowhere& out)
{
    return std::ranges::any_of(out.last(), [](std::byte b) { return b != std::byte{}; });
}

/// Measures the work of the two sides together: to(), then the audio thread's step that renders it. The
/// counter gives the periods written until a silent stroke's first point is in one.
void live_point(benchmark::State& state)
{
    const auto period = static_cast<unsigned>(state.range(0));
    const array a = bench::square(9);
    stream s(9, period);
    const auto live =
        std::make_shared<live_stroke::impl>(stroke_id{1}, a, layout(a), s.out.setup(), live_options{});
    s.feed.submit({1}, std::shared_ptr<engine::live_voice>(live, &live->voice));
    s.pump();
    live->to({0.0, 0.0}, 1.0);
    unsigned waited = 0;
    do {
        s.loop.step(io_kind::ok, 0);
        ++waited;
    } while (!sounds(s.out) && waited < 100);
    double x = 0.0;
    for (auto _ : state) {
        x = x < 40.0 ? x + 0.01 : 0.0;
        live->to({x, 20.0}, 1.0);
        s.loop.step(io_kind::ok, 0);
    }
    state.counters["periods_to_first_sample"] = waited;
}

/// Measures a period of 96 frames of the audio thread on 64 channels while so many live strokes sound, each
/// of which gets a point in every period.
void live_strokes(benchmark::State& state)
{
    const array a = bench::square(64);
    stream s(64, 96);
    std::vector<std::shared_ptr<live_stroke::impl>> all;
    for (std::uint32_t n = 1; n <= static_cast<std::uint32_t>(state.range(0)); ++n) {
        all.push_back(std::make_shared<live_stroke::impl>(stroke_id{n}, a, layout(a), s.out.setup(),
                                                          live_options{.render = {.level_dbfs = -50.0}}));
        s.feed.submit({n}, std::shared_ptr<engine::live_voice>(all.back(), &all.back()->voice));
    }
    s.pump();
    double moved_mm = 0.0;
    for (auto _ : state) {
        moved_mm = moved_mm < 100.0 ? moved_mm + 0.1 : 0.0;
        for (std::size_t n = 0; n < all.size(); ++n)
            all[n]->to({moved_mm, 2.0 * static_cast<double>(n)}, 1.0);
        s.measure_step(state);
    }
    const double periods_s = static_cast<double>(state.iterations()) * 96.0 / 48000.0;
    state.counters["mean_%_of_a_core"] = 100.0 * s.total / periods_s;
    state.counters["worst_%_of_a_core"] = 100.0 * s.worst * 48000.0 / 96.0;
    state.counters["sound"] = static_cast<double>(
        std::ranges::count_if(all, [](const auto& one) { return one->voice.rendered() != 0; }));
}
BENCHMARK(live_strokes)
    ->Name("live/strokes_on_64_channels")
    ->Arg(1)
    ->Arg(16)
    ->Arg(64)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

BENCHMARK(live_point)
    ->Name("live/point_and_period")
    ->Arg(48)
    ->Arg(96)
    ->MinTime(0.02)
    ->Repetitions(5)
    ->Unit(benchmark::kMicrosecond);

} // namespace
