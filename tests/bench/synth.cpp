// SPDX-License-Identifier: MIT
// The audio thread's mixer over blocks of 10 ms that stay in the cache, against what bounds it: the same
// bytes set and copied, and a loop that one would write first.
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "pieces.hpp"
#include "report.hpp"
#include "synth/event_source.hpp"
#include "synth/mixer.hpp"

using namespace tactor;

namespace {

/// All events of a piece, as they come over the ring.
struct events {
    explicit events(const score& s) : frames(s.frames())
    {
        for (synth::event_source source(s); const synth::drive_event* e = source.peek(); source.pop())
            all.push_back(*e);
    }
    std::vector<synth::drive_event> all; ///< by start
    std::uint64_t frames;
};

/// A mixer that is fed block by block, from the beginning again at the end.
class player {
public:
    player(const events& e, unsigned channels, sample_format f)
        : events_(e), mix_(std::vector<double>(channels, 1.0), f)
    {
    }
    void process(std::byte* out)
    {
        if (mix_.position() >= events_.frames) {
            mix_.reset();
            next_ = 0;
        }
        while (next_ < events_.all.size() && events_.all[next_].start < mix_.position() + bench::block &&
               mix_.add(events_.all[next_])) {
            ++next_;
        }
        mix_.process(bench::block, out);
    }

private:
    const events& events_;
    synth::mixer mix_;
    std::size_t next_ = 0;
};

void mix(benchmark::State& state, const events& e, unsigned channels, sample_format f)
{
    std::vector<std::byte> out(bench::block * channels * bytes_of(f));
    player p(e, channels, f);
    for (auto _ : state) {
        p.process(out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
}

void plain(benchmark::State& state, const bench::plain_loop& fresh, unsigned channels)
{
    std::vector<float> out(bench::block * channels);
    bench::plain_loop p = fresh;
    for (auto _ : state) {
        if (p.at_end()) {
            state.PauseTiming();
            p = fresh;
            state.ResumeTiming();
        }
        p.process(bench::block, out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
}

template <class F>
void bytes(benchmark::State& state, std::size_t n, F f)
{
    const std::vector<std::byte> in(n, std::byte{1});
    std::vector<std::byte> out(n);
    for (auto _ : state) {
        f(out.data(), in.data(), n);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
}

template <class F>
void add(const std::string& name, F f)
{
    benchmark::RegisterBenchmark(name.c_str(), f)->MinTime(0.01)->Repetitions(12);
}

void add_bounds(unsigned channels, std::size_t sample)
{
    const std::size_t n = bench::block * channels * sample;
    add(bench::name_of("memset", n), [n](benchmark::State& state) {
        bytes(state, n, [](std::byte* out, const std::byte*, std::size_t m) { std::memset(out, 0, m); });
    });
    add(bench::name_of("memcpy", n), [n](benchmark::State& state) {
        bytes(state, n, [](std::byte* out, const std::byte* in, std::size_t m) { std::memcpy(out, in, m); });
    });
}

void add_piece(unsigned channels, unsigned count, algorithm method)
{
    const score s = bench::piece(channels, count, method);
    const auto e = std::make_shared<const events>(s);
    const bench::plain_loop fresh(s, 0.2 / count);
    bench::synth_row row{channels, count, method == algorithm::continuous, sample_format::float32};
    add(row.plain_name(), [=](benchmark::State& state) { plain(state, fresh, channels); });
    for (const sample_format f : {sample_format::float32, sample_format::s16, sample_format::s32}) {
        row.format = f;
        add(row.name(), [=](benchmark::State& state) { mix(state, *e, channels, f); });
        bench::table().push_back(row);
    }
}

void add_silence(unsigned channels)
{
    const auto e = std::make_shared<events>(bench::piece(channels, 1, algorithm::park2016));
    e->all.clear();
    const bench::synth_row row{channels, 0, false, sample_format::float32};
    add(row.name(), [=](benchmark::State& state) { mix(state, *e, channels, sample_format::float32); });
    bench::table().push_back(row);
}

} // namespace

void bench::add_synth()
{
    for (const unsigned channels : {9U, 16U, 64U}) {
        add_bounds(channels, 2);
        add_bounds(channels, 4);
        add_silence(channels);
        for (const unsigned count : {1U, 8U, 64U}) {
            add_piece(channels, count, algorithm::park2016);
            add_piece(channels, count, algorithm::continuous);
        }
    }
}
