// SPDX-License-Identifier: MIT
// From a live point to the period in which it sounds.
#include <algorithm>
#include <memory>

#include <benchmark/benchmark.h>

#include "engine/audio/audio_loop.hpp"
#include "engine/control/feeder.hpp"
#include "engine/live/live_stroke.hpp"
#include "nowhere.hpp"
#include "pieces.hpp"

using namespace tactor;

namespace {

bool sounds(const bench::nowhere& out)
{
    return std::any_of(out.last().begin(), out.last().end(), [](std::byte b) { return b != std::byte{}; });
}

/// The work of the two sides together: to(), then the audio thread's step that renders it. The counter says
/// how many periods are written until a silent stroke's first point is in one.
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
BENCHMARK(live_point)
    ->Name("live/point_and_period")
    ->Arg(48)
    ->Arg(96)
    ->MinTime(0.02)
    ->Repetitions(5)
    ->Unit(benchmark::kMicrosecond);

} // namespace
