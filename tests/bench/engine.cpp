// SPDX-License-Identifier: MIT
// Cost of a period for the audio thread while 64 strokes sound on 64 channels: the mean, and the worst.
#include <algorithm>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "engine/audio/audio_loop.hpp"
#include "engine/control/feeder.hpp"
#include "nowhere.hpp"
#include "pieces.hpp"
#include "synth/guard.hpp"

using namespace tactor;

namespace {

std::vector<score> scores(algorithm_kind method)
{
    const array a = bench::square(64);
    std::vector<score> all;
    for (const plan& p : bench::strokes(a, 64, method))
        all.emplace_back(a, std::vector<placed_plan>{{p, {}}}, bench::levels(64));
    return all;
}

void submit(engine::feeder& feed, engine::link& link, stroke_id& id, const std::vector<score>& strokes)
{
    for (const score& s : strokes)
        feed.submit({++id.number}, s, start_at::frame(link.status.load().written + 4800));
}

/// Measures a step of the audio thread, a period. The control thread feeds it; counts the periods in which it
/// had to wake up, and its time.
void periods(benchmark::State& state, algorithm_kind method, double power_dbfs)
{
    const auto period = static_cast<unsigned>(state.range(0));
    const std::vector<score> strokes = scores(method);
    bench::nowhere out(64, period);
    engine::link link;
    engine::feeder feed(link, 24'000);
    engine::loop_options o;
    o.guards = synth::make_guards({.power_dbfs = power_dbfs}, 48000);
    engine::audio_loop loop(out, link, std::vector<double>(64, 1.0), o);
    loop.start(0);
    stroke_id id = {};
    std::size_t ended = 64;
    double worst = 0.0;
    double total = 0.0;
    double feeding = 0.0;
    std::uint64_t wakes = 0;
    for (auto _ : state) {
        const double begun = bench::cpu_s();
        wakes += link.to_control.consume() > 0 ? 1 : 0;
        engine::report r;
        while (link.reports.pop(r))
            feed.handle(r);
        ended += std::exchange(feed.reports(), {}).size();
        feed.beginnings().clear();
        if (ended >= 64) {
            ended = 0;
            submit(feed, link, id, strokes);
        }
        feed.pump(link.status.load().written, link.clock.load());
        const double from = bench::cpu_s();
        feeding += from - begun;
        loop.step(io_kind::ok, 0);
        const double took = bench::cpu_s() - from;
        state.SetIterationTime(took);
        worst = std::max(worst, took);
        total += took;
    }
    const double period_s = period / 48000.0;
    state.counters["worst_us"] = worst * 1e6;
    state.counters["worst_%_of_a_core"] = 100.0 * worst / period_s;
    const auto all = static_cast<double>(state.iterations());
    state.counters["mean_%_of_a_core"] = 100.0 * total / (all * period_s);
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

} // namespace
