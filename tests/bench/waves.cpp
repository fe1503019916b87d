// SPDX-License-Identifier: MIT
// Cost of waves beside a sine: 16 strokes at once on 64 channels, each with its own, in blocks of 10 ms.
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <tactor/tactor.hpp>

#include "pieces.hpp"

using namespace tactor;

namespace {

waveform recorded(texture_kind texture)
{
    recording r{"bench", 8000.0, std::vector<float>(4000)};
    for (std::size_t i = 0; i < r.samples.size(); ++i)
        r.samples[i] = static_cast<float>(std::sin(1e-4 * static_cast<double>(i * i)));
    waveform w;
    w.kind = waveform_kind::recording;
    w.recorded = std::make_shared<const recording>(std::move(r));
    w.texture = texture;
    return w;
}

void play(benchmark::State& state, const waveform& w, const modulation& m)
{
    const array a = bench::square(64);
    std::vector<placed_plan> plans;
    for (plan& p : bench::strokes(a, 16, algorithm_kind::continuous)) {
        p.wave = w;
        p.am = m;
        plans.push_back({std::move(p), 0.0});
    }
    const score s(a, plans, bench::levels(16));
    std::vector<std::byte> out(bench::block * s.channels() * sizeof(float));
    auto r = std::make_unique<renderer>(s, format_kind::float32);
    for (auto _ : state) {
        if (r->position() + bench::block > s.frames()) {
            state.PauseTiming();
            r = std::make_unique<renderer>(s, format_kind::float32);
            state.ResumeTiming();
        }
        r->process(out);
        benchmark::DoNotOptimize(out.data());
    }
    // A block lasts 10 ms: 5 % of a core are 500 us.
    state.counters["core"] =
        benchmark::Counter(0.01, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

waveform shaped(waveform_kind k)
{
    waveform w;
    w.kind = k;
    return w;
}

[[maybe_unused]] const bool added = [] {
    const auto add = [](const char* name, const waveform& w, const modulation& m) {
        benchmark::RegisterBenchmark((std::string("16 strokes of 64 channels/") + name).c_str(),
                                     [w, m](benchmark::State& state) { play(state, w, m); })
            ->Unit(benchmark::kMicrosecond);
    };
    add("sine", shaped(waveform_kind::sine), {});
    add("square", shaped(waveform_kind::square), {});
    add("noise", shaped(waveform_kind::noise), {});
    add("recording, cycle", recorded(texture_kind::cycle), {});
    add("recording, time", recorded(texture_kind::time), {});
    add("sine, modulated", shaped(waveform_kind::sine), {30.0, 1.0});
    return true;
}();

} // namespace
