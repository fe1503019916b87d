// SPDX-License-Identifier: MIT
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
    for (auto _ : state) {
        benchmark::DoNotOptimize(make_plan(a, l, s, {}));
    }
}
BENCHMARK(plan_park)->Name("plan/park2016-1")->Unit(benchmark::kMicrosecond);

/// The drives of random points on a square array.
void locate(benchmark::State& state)
{
    const auto side = static_cast<unsigned>(state.range(0));
    const layout l(make_grid("square", side, side, 20.0, 20.0));
    const auto model = make_phantom(phantom_kind::inverse_distance, l);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> place(0.0, 20.0 * (side - 1));
    std::vector<point> points(1024);
    for (point& p : points) {
        p = {place(random), place(random)};
    }
    std::vector<drive> drives;
    std::size_t i = 0;
    for (auto _ : state) {
        model->weights(points[i++ % points.size()], 1.0, drives);
        benchmark::DoNotOptimize(drives.data());
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}
BENCHMARK(locate)->Name("phantom/tactors_side")->Arg(3)->Arg(8)->Arg(32)->Arg(128);

} // namespace
