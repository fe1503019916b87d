// SPDX-License-Identifier: MIT
// From a live point to the period in which it sounds.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "engine/audio/audio_loop.hpp"
#include "engine/control/feeder.hpp"
#include "engine/live.hpp"
#include "nowhere.hpp"
#include "pieces.hpp"

using namespace tactor;

namespace {

bool sounds(const bench::nowhere& out)
{
    return std::any_of(out.last().begin(), out.last().end(), [](std::byte b) { return b != std::byte{}; });
}

/// Measures the work of the two sides together: to(), then the audio thread's step that renders it. The
/// counter gives the periods written until a silent stroke's first point is in one.
void live_point(benchmark::State& state)
{
    const auto period = static_cast<unsigned>(state.range(0));
    const array a = bench::square(9);
    bench::nowhere out(9, period);
    engine::link link;
    engine::feeder feed(link, 24'000);
    engine::audio_loop loop(out, link, std::vector<double>(9, 1.0), {});
    loop.start(0);
    const auto live =
        std::make_shared<live_stroke::impl>(stroke_id{1}, a, layout(a), out.setup(), live_options{});
    feed.submit({1}, std::shared_ptr<engine::live_voice>(live, &live->voice));
    feed.pump(link.status.load().written, link.clock.load());
    live->to({0.0, 0.0}, 1.0);
    unsigned waited = 0;
    do {
        loop.step(io_kind::ok, 0);
        ++waited;
    } while (!sounds(out) && waited < 100);
    double x = 0.0;
    for (auto _ : state) {
        x = x < 40.0 ? x + 0.01 : 0.0;
        live->to({x, 20.0}, 1.0);
        loop.step(io_kind::ok, 0);
    }
    state.counters["periods_to_first_sample"] = waited;
}
/// Measures a period of 96 frames of the audio thread on 64 channels while so many live strokes sound, each
/// of which gets a point in every period.
void live_strokes(benchmark::State& state)
{
    const array a = bench::square(64);
    bench::nowhere out(64, 96);
    engine::link link;
    engine::feeder feed(link, 24'000);
    engine::audio_loop loop(out, link, std::vector<double>(64, 1.0), {});
    loop.start(0);
    std::vector<std::shared_ptr<live_stroke::impl>> all;
    for (std::uint32_t n = 1; n <= static_cast<std::uint32_t>(state.range(0)); ++n) {
        all.push_back(std::make_shared<live_stroke::impl>(stroke_id{n}, a, layout(a), out.setup(),
                                                          live_options{.render = {.level_dbfs = -50.0}}));
        feed.submit({n}, std::shared_ptr<engine::live_voice>(all.back(), &all.back()->voice));
    }
    feed.pump(link.status.load().written, link.clock.load());
    double moved_mm = 0.0;
    double total = 0.0;
    double worst = 0.0;
    for (auto _ : state) {
        moved_mm = moved_mm < 100.0 ? moved_mm + 0.1 : 0.0;
        for (std::size_t n = 0; n < all.size(); ++n)
            all[n]->to({moved_mm, 2.0 * static_cast<double>(n)}, 1.0);
        const double from = bench::cpu_s();
        loop.step(io_kind::ok, 0);
        const double took = bench::cpu_s() - from;
        state.SetIterationTime(took);
        total += took;
        worst = std::max(worst, took);
    }
    const double periods_s = static_cast<double>(state.iterations()) * 96.0 / 48000.0;
    state.counters["mean_%_of_a_core"] = 100.0 * total / periods_s;
    state.counters["worst_%_of_a_core"] = 100.0 * worst * 48000.0 / 96.0;
    state.counters["sound"] = static_cast<double>(
        std::count_if(all.begin(), all.end(), [](const auto& s) { return s->voice.rendered() != 0; }));
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
