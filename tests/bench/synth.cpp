// SPDX-License-Identifier: MIT
#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>

#include "pieces.hpp"

using namespace tactor;

namespace {

void count(benchmark::State& state, const score& s, sample_format f = sample_format::float32)
{
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * bench::block));
    state.SetBytesProcessed(
        static_cast<std::int64_t>(state.iterations() * bench::block * s.channels() * bytes_of(f)));
}

void render(benchmark::State& state, const score& s, sample_format f)
{
    std::vector<std::byte> out(bench::block * s.channels() * bytes_of(f));
    renderer r(s, f);
    for (auto _ : state) {
        if (r.position() >= s.frames()) {
            state.PauseTiming();
            r = renderer(s, f);
            state.ResumeTiming();
        }
        r.process(bench::block, out.data());
        benchmark::DoNotOptimize(out.data());
    }
    count(state, s, f);
}

void plain(benchmark::State& state, const score& s)
{
    std::vector<float> out(bench::block * s.channels());
    const bench::plain_loop fresh(s);
    bench::plain_loop p = fresh;
    for (auto _ : state) {
        if (p.at_end()) {
            state.PauseTiming();
            p = fresh;
            state.ResumeTiming();
        }
        p.process(bench::block, out.data());
        benchmark::DoNotOptimize(out.data());
    }
    count(state, s);
}

void set(benchmark::State& state, const score& s)
{
    std::vector<float> out(bench::block * s.channels());
    for (auto _ : state) {
        std::memset(out.data(), 0, out.size() * sizeof(float));
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count(state, s);
}

void copy(benchmark::State& state, const score& s)
{
    std::vector<float> in(bench::block * s.channels(), 1.0F);
    std::vector<float> out(in.size());
    for (auto _ : state) {
        std::memcpy(out.data(), in.data(), out.size() * sizeof(float));
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count(state, s);
}

void add(const char* name, score (*make)())
{
    const std::string prefix(name);
    const score s = make();
    const auto with = [&prefix, &s](const char* what, auto f) {
        benchmark::RegisterBenchmark((prefix + "/" + what).c_str(),
                                     [s, f](benchmark::State& state) { f(state, s); });
    };
    with("mixer_float",
         [](auto& state, const score& piece) { render(state, piece, sample_format::float32); });
    with("mixer_s16", [](auto& state, const score& piece) { render(state, piece, sample_format::s16); });
    with("mixer_s24", [](auto& state, const score& piece) { render(state, piece, sample_format::s24_3); });
    with("mixer_s32", [](auto& state, const score& piece) { render(state, piece, sample_format::s32); });
    with("std_sin", plain);
    with("memset", set);
    with("memcpy", copy);
}

const bool added = [] {
    add("synth_9", bench::palm);
    add("synth_64", bench::field);
    return true;
}();

} // namespace
