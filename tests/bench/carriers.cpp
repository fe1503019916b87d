// SPDX-License-Identifier: MIT
// Many strokes at once, each a frame later than the one before it, with one carrier or with one each.
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include <tactor/tactor.hpp>

#include "pieces.hpp"

using namespace tactor;

namespace {

constexpr unsigned strokes_at_once = 1024;
constexpr unsigned rate = 48000;

/// Makes a burst of three tactors.
placed_plan one_burst(unsigned number, bool own_carrier)
{
    plan p;
    p.carrier_hz = own_carrier ? 100.0 + 0.25 * number : 250.0;
    p.total_s = p.stroke_duration_s = 2.0;
    burst b;
    b.duration_s = p.total_s;
    for (unsigned i = 0; i < 3; ++i)
        b.drives.push_back({(number + i) % 7 + i, 1.0});
    p.bursts = {b};
    return {p, static_cast<double>(number) / rate};
}

void carriers(benchmark::State& state)
{
    std::vector<placed_plan> plans;
    for (unsigned i = 0; i < strokes_at_once; ++i)
        plans.push_back(one_burst(i, state.range(0) > 1));
    render_options o;
    o.rate = rate;
    o.level_dbfs = -70.0;
    const score s(preset_array("palm-3x3"), plans, o);
    std::vector<std::byte> out(bench::block * s.channels() * sizeof(float));
    renderer r(s, format_kind::float32);
    for (auto _ : state) {
        if (r.position() + bench::block > s.frames()) {
            state.PauseTiming();
            r = renderer(s, format_kind::float32);
            state.ResumeTiming();
        }
        r.process(out);
        benchmark::DoNotOptimize(out.data());
    }
}
BENCHMARK(carriers)
    ->Name("1024 strokes at once/carriers")
    ->Arg(1)
    ->Arg(strokes_at_once)
    ->Unit(benchmark::kMicrosecond);

} // namespace
