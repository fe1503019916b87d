// SPDX-License-Identifier: MIT
// The audio thread's mixer over blocks of 10 ms that stay in the cache, against its bounds: the same bytes
// set and copied, and a first draft of a mixer. Whole scores as `render` makes them, with other waves than a
// sine and with a carrier for each stroke.
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pieces.hpp"
#include "report.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/event_source.hpp"

using namespace tactor;

namespace {

/// Events of a piece, as they come over the ring.
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
    player(const events& e, unsigned channels, format_kind f)
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
               mix_.add(events_.all[next_]))
            ++next_;
        mix_.process(bench::block, out);
    }

private:
    const events& events_;
    synth::mixer mix_;
    std::size_t next_ = 0;
};

void mix(benchmark::State& state, const events& e, unsigned channels, format_kind f)
{
    std::vector<std::byte> out(bench::block * channels * sample_bytes(f));
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
    add(bench::benchmark_name("memset", n), [n](benchmark::State& state) {
        bytes(state, n, [](std::byte* out, const std::byte*, std::size_t m) { std::memset(out, 0, m); });
    });
    add(bench::benchmark_name("memcpy", n), [n](benchmark::State& state) {
        bytes(state, n, [](std::byte* out, const std::byte* in, std::size_t m) { std::memcpy(out, in, m); });
    });
}

/// Made at its first use.
class prepared {
public:
    explicit prepared(const bench::synth_row& r) : row_(r) {}
    const events& all()
    {
        make();
        return *events_;
    }
    const bench::plain_loop& plain()
    {
        make();
        return *plain_;
    }

private:
    void make()
    {
        if (events_ == nullptr) {
            const unsigned count = std::max(1U, row_.strokes);
            const algorithm_kind algorithm =
                row_.continuous ? algorithm_kind::continuous : algorithm_kind::park2016;
            const score s = bench::piece(row_.channels, count, algorithm);
            events_ = std::make_unique<events>(s);
            plain_ = std::make_unique<bench::plain_loop>(s, bench::plans(row_.channels, count, algorithm),
                                                         0.2 / count);
            if (row_.strokes == 0)
                events_->all.clear();
        }
    }
    bench::synth_row row_;
    std::unique_ptr<events> events_;
    std::unique_ptr<bench::plain_loop> plain_;
};

void add_piece(bench::synth_row row)
{
    const auto p = std::make_shared<prepared>(row);
    const unsigned channels = row.channels;
    add(row.plain_name(), [=](benchmark::State& state) { plain(state, p->plain(), channels); });
    for (const format_kind f : {format_kind::float32, format_kind::s16, format_kind::s32}) {
        row.format = f;
        add(row.name(), [=](benchmark::State& state) { mix(state, p->all(), channels, f); });
        bench::table().push_back(row);
    }
}

/// Renders a score like `render`, from the first frame to the last and again.
void whole(benchmark::State& state, const score& s)
{
    std::vector<std::byte> out(bench::block * s.channels() * sizeof(float));
    renderer r(s, format_kind::float32);
    for (auto _ : state) {
        if (r.position() >= s.frames()) {
            state.PauseTiming();
            r = renderer(s, format_kind::float32);
            state.ResumeTiming();
        }
        r.process(out);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
}

/// Renders park2016-1 on nine channels, in its own time and in a minute, without keeping the samples.
void add_renderer(algorithm_kind method)
{
    for (const double duration_s : {1.4, 60.0}) {
        plan_options o;
        o.algorithm = method;
        stroke k = preset_stroke("park2016-1");
        k.motion = k.motion.with_duration(duration_s);
        const array a = bench::square(9);
        const score s(a, {{make_plan(a, k, o), {}}}, bench::levels(1));
        add(fmt::format("renderer/{}/{}_s", to_string(method), duration_s),
            [s](benchmark::State& state) { whole(state, s); });
    }
}

/// Renders a minute from corner to corner of nine tactors: straight, along a cubic and an arc of an ellipse,
/// and along a row of them, which are on the border between two faces, with two phantom models.
void add_renderer_ways()
{
    const array a = bench::square(9);
    const auto& [x, y] = a.tactors.back().position;
    const auto& [left, top] = a.tactors.front().position;
    const auto at = [&](double u, double v) { return point{left + u * (x - left), top + v * (y - top)}; };
    const auto svg = [](point p) { return fmt::format("{} {}", p.x_mm, p.y_mm); };
    struct way {
        std::string name;
        path drawn;
        phantom_kind phantom = phantom_kind::inverse_distance;
    };
    const path row = path::from_svg("M " + svg(at(0.0, 0.5)) + " L " + svg(at(1.0, 0.5)));
    const std::vector<way> ways{
        {"line", path::from_svg("M " + svg(at(0.05, 0.1)) + " L " + svg(at(0.95, 0.8)))},
        {"ellipse", path::from_svg("M " + svg(at(0.05, 0.5)) +
                                   fmt::format(" A {} {} 0 0 1 ", 0.45 * (x - left), 0.35 * (y - top)) +
                                   svg(at(0.95, 0.5)))},
        {"cubic", path::from_svg("M " + svg(at(0.05, 0.25)) + " C " + svg(at(0.5, 0.95)) + " " +
                                 svg(at(0.5, 0.05)) + " " + svg(at(0.95, 0.75)))},
        {"row", row},
        {"row_barycentric", row, phantom_kind::barycentric}};
    for (const auto& [name, drawn, phantom] : ways) {
        plan_options o;
        o.algorithm = algorithm_kind::continuous;
        o.phantom = phantom;
        const score s(a, {{make_plan(a, stroke{name, trajectory::along(drawn, 60.0)}, o), {}}},
                      bench::levels(1));
        add(fmt::format("renderer/continuous/{}", name), [s](benchmark::State& state) { whole(state, s); });
    }
}

/// Makes a burst of three tactors, each a frame later than that before it.
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
    return {p, number / 48000.0};
}

/// Plays many strokes at once, with one carrier or with one each.
void carriers(benchmark::State& state)
{
    std::vector<placed_plan> plans;
    for (unsigned i = 0; i < 1024; ++i)
        plans.push_back(one_burst(i, state.range(0) > 1));
    whole(state, score(preset_array("palm-3x3"), plans, {.level_dbfs = -70.0}));
}
BENCHMARK(carriers)->Name("1024 strokes at once/carriers")->Arg(1)->Arg(1024)->Unit(benchmark::kMicrosecond);

waveform recorded(texture_kind texture)
{
    recording r{"bench", 8000.0, std::vector<float>(4000)};
    for (std::size_t i = 0; i < r.samples.size(); ++i)
        r.samples[i] = static_cast<float>(std::sin(1e-4 * static_cast<double>(i * i)));
    return {.kind = waveform_kind::recording,
            .recorded = std::make_shared<const recording>(std::move(r)),
            .texture = texture};
}

/// Plays 16 strokes at once on 64 channels, each with its own wave.
void add_wave(const std::string& name, const waveform& w, const modulation& m = {})
{
    const auto play = [w, m](benchmark::State& state) {
        const array a = bench::square(64);
        std::vector<placed_plan> plans;
        for (plan& p : bench::strokes(a, 16, algorithm_kind::continuous)) {
            p.wave = w;
            p.am = m;
            plans.push_back({std::move(p), 0.0});
        }
        whole(state, score(a, plans, bench::levels(16)));
        // A block lasts 10 ms: 5 % of a core are 500 us.
        state.counters["core"] = benchmark::Counter(0.01, benchmark::Counter::kIsIterationInvariantRate |
                                                              benchmark::Counter::kInvert);
    };
    benchmark::RegisterBenchmark(("16 strokes of 64 channels/" + name).c_str(), play)
        ->Unit(benchmark::kMicrosecond);
}

} // namespace

void bench::add_synth()
{
    add_renderer(algorithm_kind::park2016);
    add_renderer(algorithm_kind::continuous);
    add_renderer_ways();
    add_wave("sine", {});
    add_wave("square", {.kind = waveform_kind::square});
    add_wave("noise", {.kind = waveform_kind::noise});
    add_wave("recording, cycle", recorded(texture_kind::cycle));
    add_wave("recording, time", recorded(texture_kind::time));
    add_wave("sine, modulated", {}, {30.0, 1.0});
    for (const unsigned channels : {9U, 16U, 64U}) {
        add_bounds(channels, 2);
        add_bounds(channels, 4);
        add_piece({.channels = channels, .strokes = 0});
        for (const unsigned count : {1U, 8U, 64U})
            for (const bool continuous : {false, true})
                add_piece({.channels = channels, .strokes = count, .continuous = continuous});
    }
}
