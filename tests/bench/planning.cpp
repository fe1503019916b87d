// SPDX-License-Identifier: MIT
#include <chrono>
#include <random>

#include <benchmark/benchmark.h>

#include <tactor/tactor.hpp>

using namespace tactor;

namespace {

void plan_park(benchmark::State& state)
{
    const array a = preset_array("palm-3x3");
    const layout l(a);
    const stroke s = preset_stroke("park2016-1");
    for (auto _ : state)
        benchmark::DoNotOptimize(make_plan(a, l, s, {}));
}
BENCHMARK(plan_park)->Name("plan/park2016-1")->Unit(benchmark::kMicrosecond);

/// Measures long strokes, where only the bursts take time.
void plan_burst(benchmark::State& state, const stroke& s)
{
    const array a = preset_array("palm-3x3");
    const layout l(a);
    const stroke longer{s.name, s.motion.with_duration(600.0)};
    for (auto _ : state) {
        const auto from = std::chrono::steady_clock::now();
        const plan p = make_plan(a, l, longer, {});
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - from;
        state.SetIterationTime(took.count() / static_cast<double>(p.bursts.size()));
    }
}
// Each iteration is thousands of bursts, though its time is that of one.
BENCHMARK_CAPTURE(plan_burst, circle, preset_stroke("park2016-1"))
    ->Name("plan/a burst of park2016-1")
    ->Iterations(20)
    ->UseManualTime();
BENCHMARK_CAPTURE(plan_burst, cubic,
                  stroke{"cubic", trajectory::along(path::from_svg("M 0 10 C 20 -5 20 45 40 30"), 1.0)})
    ->Name("plan/a burst along a cubic")
    ->Iterations(20)
    ->UseManualTime();

/// Measures the drives of random points on a square array.
void locate(benchmark::State& state, faces_kind faces)
{
    const auto side = static_cast<unsigned>(state.range(0));
    const layout l(make_grid("square", side, side, 20.0, 20.0));
    const auto model = make_phantom(phantom_kind::inverse_distance, l, faces);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> place(0.0, 20.0 * (side - 1));
    std::vector<point> points(1024);
    for (point& p : points)
        p = {place(random), place(random)};
    std::vector<drive> drives;
    std::size_t i = 0;
    for (auto _ : state) {
        model->weights(points[i++ % points.size()], 1.0, drives);
        benchmark::DoNotOptimize(drives.data());
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}
BENCHMARK_CAPTURE(locate, faces, faces_kind::delaunay)
    ->Name("phantom/tactors_side")
    ->Arg(3)
    ->Arg(8)
    ->Arg(23)
    ->Arg(32);
BENCHMARK_CAPTURE(locate, nearest, faces_kind::nearest)
    ->Name("phantom/nearest/tactors_side")
    ->Arg(3)
    ->Arg(8)
    ->Arg(23)
    ->Arg(32);

} // namespace
