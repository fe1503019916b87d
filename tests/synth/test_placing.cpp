// SPDX-License-Identifier: MIT
// Pieces: where strokes begin and sound, markers, and what renderers allocate.
#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "caught.hpp"
#include "count_allocations.hpp"
#include "own_curve.hpp"
#include "pieces.hpp"
#include "rounds.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/event_source.hpp"
#include "synth/score/frames.hpp"
#include "synth/score/score_view.hpp"

namespace placing_test {

using namespace tactor;
using namespace pieces;
using namespace tactor::synth;
using namespace tactor::test;

namespace {

render_options marked(unsigned channel, unsigned channels)
{
    return {.channels = channels, .marker_channel = channel};
}

score two_strokes(const render_options& o)
{
    const plan p = make_plan({make_burst(0.0, 0.05, {{0, 1.0}, {1, 0.5}})});
    return {row(3), {{p, {}}, {p, 0.1234}}, o};
}

score busy_score()
{
    std::mt19937_64 random(31);
    return {row(9),
            {{make_random(random, 9, 100, 1.0), {}},
             {make_continuous(9, 0.8), 0.1},
             {make_continuous(9, 0.8), 0.5}},
            {.level_dbfs = -40.0}};
}

} // namespace

TEST_CASE("plans follow each other unless they are placed")
{
    const plan p = make_plan({make_burst(0.01, 0.0413, {{0, 0.5}})});
    const score s(row(2), {{p, {}}, {p, {}}, {p, 0.02}, {p, {}}}, {.rate = 44100});
    const auto length = static_cast<std::uint64_t>(std::llround(0.0513 * 44100));
    CHECK((s.starts() == std::vector<std::uint64_t>{0, length, 882, 882 + length}));
    CHECK(s.frames() == 882 + 2 * length);
    CHECK(s.plans().size() == 4);
    CHECK(s.rate() == 44100);
    CHECK(s.channels() == 2);
}

TEST_CASE("strokes in a row begin at their times, however many there are, at full scale")
{
    for (const double frames : {9600.0, 9600.49, 9600.51, 9600.99}) {
        CAPTURE(frames);
        const double seconds = frames / 48000.0;
        const plan p = make_plan({make_burst(0.0, seconds, {{0, 1.0}})});
        std::vector<placed_plan> plans(1000, placed_plan{p, {}});
        plans.push_back({p, 0.0, {start_from_kind::end, 1}});
        const score s(row(1), plans, {.level_dbfs = 0.0});
        const std::vector<double> starts_s = start_times_s(plans);
        for (std::size_t i = 0; i < plans.size(); ++i)
            REQUIRE(s.starts()[i] == synth::frame_at(starts_s[i], 48000));
        CHECK(std::abs(static_cast<double>(s.starts().back()) - 1000.0 * frames) <= 0.51);
    }
}

TEST_CASE("a burst that cannot be placed is refused with a hint")
{
    const auto refusal = [](const burst& b) {
        return caught_message([&] { return score(row(2), {{make_plan({b}), {}}}, render_options()); });
    };
    CHECK(refusal(make_burst(0.0, 0.05, {{7, 0.5}})) ==
          "burst 1 of the plan: tactor 7 is not in the array, which has 2 (plan the stroke for this array)");
    CHECK(refusal(make_burst(0.0, 0.05, {{1, HUGE_VAL}})) ==
          "burst 1 of the plan: the amplitude of tactor 1 is inf (give a finite number)");
    CHECK(refusal(make_burst(-1.0, 0.05, {{1, 0.5}})).ends_with("(use 0 to 1000000 s)"));
}

TEST_CASE("starts count from the start or the end of plans before")
{
    const plan p = make_plan({make_burst(0.0, 0.05, {{0, 0.5}})});
    const plan longer = make_plan({make_burst(0.0, 0.2, {{1, 0.5}})});
    constexpr auto start = start_from_kind::start;
    constexpr auto end = start_from_kind::end;
    const std::vector<placed_plan> plans{{p, 0.1},
                                         {longer, 0.01, {start, 1}},
                                         {p, 0.0, {end, 1}},
                                         {p, 0.02, {end, 3}},
                                         {p, -0.05, {end, 1}},
                                         {p, 0.03, {start, 5}},
                                         {p, 0.5, {end, 99}}};
    const score s(row(2), plans);
    CHECK((s.starts() == std::vector<std::uint64_t>{4800, 5280, 14880, 18240, 18240, 6240, 44640}));
    const std::vector<double> seconds = start_times_s(plans);
    for (std::size_t i = 0; i < plans.size(); ++i) {
        CHECK(std::llround(seconds[i] * 48000.0) == static_cast<long long>(s.starts()[i]));
        CHECK(s.plans()[i].anchor == plans[i].anchor);
    }
    CHECK_THROWS_AS(score(row(2), {{p, {}}, {p, -0.1, {end, 1}}}), error);
}

TEST_CASE("later starts do not count from a refused plan")
{
    const plan p = make_plan({make_burst(0.0, 0.05, {{0, 0.5}})});
    score_builder made(row(2), {});
    made.add(p);
    CHECK_THROWS_AS(made.add(p, 2e6), error);
    made.add(p, 0.5, {start_from_kind::start, 1});
    CHECK((made.take().starts() == std::vector<std::uint64_t>{0, 24000}));
}

TEST_CASE("strokes that are planned while they are placed have the samples of their plans")
{
    const array a = preset_array("palm-3x3");
    const layout l(a);
    stroke first = preset_stroke("park2016-1");
    stroke second = preset_stroke("park2016-3");
    first.motion = first.motion.with_duration(150.0); // more bursts than are handed over at once
    second.start_s = 0.35;
    second.sound.carrier_hz = 180.0;
    for (const algorithm_kind algorithm : all_values<algorithm_kind>()) {
        plan_options how{.algorithm = algorithm};
        how.profile.max_soa_s = 0.2;
        first.motion = first.motion.with_duration(algorithm == algorithm_kind::park2016 ? 150.0 : 1.4);
        render_options o{.level_dbfs = -30.0};
        score_builder made(a, o);
        std::vector<placed_plan> plans;
        for (const stroke& s : {first, second}) {
            made.add(l, s, how);
            plans.push_back({make_plan(a, l, s, how), s.start_s});
        }
        const score both = made.take();
        const score expected(a, plans, o);
        for (std::size_t i = 0; i < plans.size(); ++i) {
            plans[i].plan.bursts.clear(); // they are not kept twice
            CHECK(both.plans()[i].plan == plans[i].plan);
            CHECK(both.plans()[i].start_s == plans[i].start_s);
        }
        CHECK(both.starts() == expected.starts());
        CHECK(both.frames() == expected.frames());
        const auto block = [] { return 4096; };
        const auto frames = static_cast<std::size_t>(both.frames());
        const bool same = render(both, format_kind::float32, block, frames) ==
                          render(expected, format_kind::float32, block, frames);
        CHECK(same);
        CHECK(made.take().frames() == 0); // it begins anew
    }
}

TEST_CASE("a stroke that cannot be planned or rendered is refused while it is added")
{
    const array a = preset_array("palm-3x3");
    const layout l(a);
    score_builder made(a, {});
    stroke s = preset_stroke("park2016-1");
    s.sound.carrier_hz = 30000.0;
    CHECK_THROWS_AS(made.add(l, s, {}), error);
    s.sound.carrier_hz = 250.0;
    CHECK_THROWS_AS(made.add(l, s, {.soa_s = 1.0}), error);
    s.start_s = -1.0;
    CHECK_THROWS_AS(made.add(l, s, {}), error);
}

TEST_CASE("a score without plans has no frames and renders silence")
{
    const score s(row(2), {}, {});
    CHECK(s.frames() == 0);
    const auto x = render(
        s, format_kind::s16, [] { return 64; }, 100);
    CHECK(std::all_of(x.begin(), x.end(), [](std::byte b) { return b == std::byte{0}; }));
}

TEST_CASE("spare channels are silent and channels follow the map")
{
    array a = row(2);
    a.tactors[0].channel = 3;
    const score s(a, {{make_plan({make_burst(0.0, 0.07, {{0, 0.5}, {1, 0.25}})}), {}}}, {.channels = 6});
    CHECK(s.channels() == 6);
    for (const unsigned c : {0U, 2U, 4U, 5U}) {
        const auto x = channel(s, c);
        CHECK(std::all_of(x.begin(), x.end(), [](double v) { return v == 0.0; }));
    }
    CHECK(channel(s, 3)[48] == doctest::Approx(0.5 * std::pow(10.0, -0.6)));
    CHECK(channel(s, 1)[48] == doctest::Approx(0.25 * std::pow(10.0, -0.6)));
}

TEST_CASE("events come in order of start and cover exactly the sounding frames")
{
    std::mt19937_64 random(21);
    for (int i = 0; i < tactor::test::rounds(50); ++i) {
        const score s(row(9),
                      {{make_random(random, 9, 40, 0.5), {}},
                       {make_continuous(9, 0.2), 0.3},
                       {make_random(random, 9, 10, 0.2), 0.1}},
                      {.phase = i % 2 == 0 ? phase_kind::burst : phase_kind::stroke, .level_dbfs = -30.0});
        synth::event_source source(s);
        std::uint64_t last = 0;
        std::uint64_t end = 0;
        while (const synth::drive_event* e = source.peek()) {
            REQUIRE(e->start >= last);
            REQUIRE(e->length > 0);
            REQUIRE((e->drives > 0) != (e->points > 0));
            REQUIRE(e->drives <= synth::drives_per_event);
            REQUIRE(e->points <= synth::points_per_line);
            REQUIRE(e->score == 0);
            last = e->start;
            end = std::max(end, e->start + e->length);
            source.pop();
        }
        CHECK(end <= s.frames());
        CHECK(end + 2 >= s.frames());
        source.pop();
        CHECK(source.peek() == nullptr);
    }
}

TEST_CASE("a burst of more tactors than an event holds is several events of one carrier")
{
    std::vector<drive> drives;
    for (unsigned i = 0; i < 9; ++i)
        drives.push_back({i, 0.1 * (i + 1)});
    const score s(row(9), {{make_plan({make_burst(0.01, 0.07, drives)}), {}}}, {});
    synth::event_source source(s);
    unsigned next = 0;
    for (const unsigned n : {4U, 4U, 1U}) {
        const synth::drive_event* e = source.peek();
        REQUIRE(e != nullptr);
        CHECK(e->start == 480);
        CHECK(e->length == 3360);
        CHECK(e->drives == n);
        for (unsigned i = 0; i < n; ++i)
            CHECK(e->drive[i].channel == next++);
        source.pop();
    }
    CHECK(source.peek() == nullptr);
}

TEST_CASE("a drive longer than an event continues in the next without a seam")
{
    const score s(row(1), {{make_plan({make_burst(0.0, 3000.0, {{0, 1.0}})}), {}}}, {.rate = 768000});
    REQUIRE(s.frames() == 2304000000U);
    synth::event_source source(s);
    std::uint64_t at = 0;
    while (const synth::drive_event* e = source.peek()) {
        CHECK(e->start == at);
        CHECK(e->phase_frame == at);
        CHECK(e->ramp_position == at);
        CHECK(e->window == s.frames());
        at += e->length;
        source.pop();
    }
    CHECK(at == s.frames());
}

TEST_CASE("continuous strokes are linear between control points, one carrier throughout")
{
    for (const unsigned rate : {8000U, 44100U, 48000U}) {
        const double duration = 0.2504;
        const double hz = 180.0;
        const plan p = make_continuous(3, duration, hz);
        const score s(row(3), {{p, {}}}, {.rate = rate, .ramp_s = 0.01, .level_dbfs = 0.0});
        const auto n = static_cast<std::int64_t>(std::llround(duration * rate));
        REQUIRE(s.frames() == static_cast<std::uint64_t>(n));
        for (unsigned c = 0; c < 3; ++c) {
            const auto x = channel(s, c);
            const auto amplitude = [&](double t) {
                burst b;
                p.curve->at(std::min(t, duration), b);
                for (const drive& d : b.drives)
                    if (d.tactor == c)
                        return d.amplitude;
                return 0.0;
            };
            std::int64_t step = 0;
            for (std::int64_t k = 0; k < n; ++k) {
                const auto to_frame = [&](std::int64_t i) {
                    return std::min(
                        n, static_cast<std::int64_t>(std::llround(static_cast<double>(i) * 0.001 * rate)));
                };
                while (to_frame(step + 1) <= k)
                    ++step;
                const auto from = static_cast<double>(to_frame(step));
                const auto to = static_cast<double>(to_frame(step + 1));
                const double a = amplitude(0.001 * static_cast<double>(step));
                const double b = amplitude(0.001 * static_cast<double>(step + 1));
                const double e = a + (b - a) * (static_cast<double>(k) - from) / (to - from);
                const double exact = e * window(k, n, std::llround(0.01 * rate)) * sine(hz, k, rate);
                REQUIRE(std::abs(x[static_cast<std::size_t>(k)] - exact) < 1e-6);
            }
        }
    }
}

TEST_CASE("a continuous stroke may be silent in part or throughout")
{
    plan p = make_continuous(3, 0.2);
    p.curve = test::make_curve(0.2, [](double t, burst& out) {
        out.drives.clear();
        if (t > 0.1)
            out.drives.push_back({1, 1.0});
    });
    const score s(row(3), {{p, {}}}, {});
    const auto x = channel(s, 1);
    CHECK(std::all_of(x.begin(), x.begin() + 4800, [](double v) { return v == 0.0; }));
    CHECK(std::any_of(x.begin() + 4800, x.end(), [](double v) { return v > 0.2; }));
    p.curve = test::make_curve(0.2, [](double, burst& out) { out.drives.clear(); });
    const score nothing(row(3), {{p, {}}, {p, 0.0}}, {});
    CHECK(nothing.frames() == 9600);
    synth::event_source source(nothing);
    CHECK(source.peek() == nullptr);
}

TEST_CASE("a marker is at each stroke's first frame, for its length, at full scale")
{
    const score s = two_strokes(marked(4, 6));
    const std::vector<double> x = channel(s, 4);
    REQUIRE(x.size() == s.frames());
    for (std::size_t i = 0; i < x.size(); ++i) {
        bool on = false;
        for (const std::uint64_t start : s.starts())
            on = on || (i >= start && i < start + 240);
        REQUIRE(x[i] == (on ? 1.0 : 0.0));
    }
    CHECK(s.starts()[1] == 5923);
    render_options plain = marked(4, 6);
    plain.marker_channel.reset();
    for (const unsigned c : {0U, 1U, 2U, 3U, 5U})
        CHECK((channel(s, c) == channel(two_strokes(plain), c)));
}

TEST_CASE("markers have the same bytes for any blocks, in every format, and two at once are one")
{
    std::mt19937_64 random(2);
    const plan p = make_plan({make_burst(0.0, 0.05, {{0, 1.0}})});
    const score s(row(1), {{p, {}}, {p, 0.001}, {p, 0.2}}, marked(1, 2));
    for (const format_kind f : all_formats) {
        const auto whole = render(s, f);
        CHECK((whole == render(
                            s, f, [&] { return 1 + random() % 100; }, s.frames())));
    }
    const std::vector<double> x = channel(s, 1);
    CHECK(*std::max_element(x.begin(), x.end()) == 1.0);
    CHECK(std::count(x.begin(), x.end(), 1.0) == 288 + 240);
}

TEST_CASE("a marker does not make a piece longer and may be longer than it")
{
    render_options o = marked(1, 2);
    o.marker_s = 1.0;
    const score s(row(1), {{make_plan({make_burst(0.0, 0.05, {{0, 1.0}})}), {}}}, o);
    CHECK(s.frames() == 2400);
    CHECK(channel(s, 1).back() == 1.0);
}

TEST_CASE("a marker needs a spare channel that exists")
{
    CHECK_THROWS_WITH_AS(two_strokes(marked(1, 6)),
                         "marker channel 1: it drives tactor 1 (choose a spare channel)", error);
    CHECK_THROWS_WITH_AS(two_strokes(marked(6, 6)),
                         "marker channel 6: there are 6 channels (use 7 channels or more)", error);
    for (const double length : {0.0, -1.0, 20.0, std::numeric_limits<double>::quiet_NaN()}) {
        render_options o = marked(4, 6);
        o.marker_s = length;
        CHECK_THROWS_AS(two_strokes(o), error);
    }
}

TEST_CASE("a constant never reaches a tactor")
{
    synth::mixer m(std::vector<double>{1.0, 0.0}, format_kind::float32, 8);
    synth::drive_event e = make_event(0, 100, 0.0, {1.0, 1.0, 0});
    e.drives = 2;
    e.drive[1] = {1.0, 1.0, 1};
    CHECK(m.add(e));
    CHECK(m.size() == 0);
    std::vector<float> x(200);
    m.process(100, reinterpret_cast<std::byte*>(x.data()));
    CHECK(std::all_of(x.begin(), x.end(), [](float v) { return v == 0.0F; }));
}

TEST_CASE("a sounding stroke has its given strength at each frame, at any level, and none after its end")
{
    array a = row(3);
    a.tactors[1].gain_db = -6.0;
    a.tactors[2].polarity = -1;
    plan p;
    p.total_s = 0.3;
    for (const double onset_s : {0.0, 0.1, 0.2}) {
        burst b{.onset_s = onset_s, .duration_s = 0.1};
        b.drives = {{0, 0.25 + onset_s}, {1, 0.5}, {2, 1.0}};
        p.bursts.push_back(b);
    }
    synth::sounding_now now(score(a, {{p, 0.1}}, {.rate = 10000}));
    CHECK(now.at(999) == std::vector<double>{0.0, 0.0, 0.0});
    for (const std::uint64_t frame : {1000U, 1999U, 2000U, 3500U, 3999U}) {
        CAPTURE(frame);
        const auto& levels = now.at(frame);
        REQUIRE(levels.size() == 3);
        const double onset_s = 0.1 * std::floor(static_cast<double>(frame - 1000) / 1000.0);
        CHECK(levels[0] == doctest::Approx(0.25 + onset_s));
        CHECK(levels[1] == doctest::Approx(0.5));
        CHECK(levels[2] == doctest::Approx(1.0));
    }
    CHECK(now.at(1500)[0] == doctest::Approx(0.45)); // a past one is not found again: as at 3999
    CHECK(now.at(4000) == std::vector<double>{0.0, 0.0, 0.0});
}

TEST_CASE("the least and greatest sample of each channel do not depend on the block size")
{
    std::mt19937 random(11);
    std::uniform_real_distribution<float> sample(-1.0F, 1.0F);
    for (const std::size_t channels : {1U, 2U, 3U, 9U, 16U, 64U, 300U, 5000U}) {
        CAPTURE(channels);
        sample_ranges ranges(channels);
        for (const std::size_t frames : {1U, 2U, 15U, 16U, 17U, 100U}) {
            CAPTURE(frames);
            std::vector<float> samples(frames * channels);
            std::generate(samples.begin(), samples.end(), [&] { return sample(random); });
            ranges.clear();
            const std::size_t first = frames / 3;
            ranges.add(samples.data(), first);
            ranges.add(samples.data() + first * channels, frames - first);
            bool same = true;
            for (std::size_t c = 0; c < channels; ++c) {
                float low = samples[c];
                float high = samples[c];
                for (std::size_t i = c; i < samples.size(); i += channels) {
                    low = std::min(low, samples[i]);
                    high = std::max(high, samples[i]);
                }
                const auto [least, most] = ranges.range_at(c);
                same = same && least == low && most == high;
            }
            CHECK(same);
        }
    }
}

COUNTING_TEST_CASE("rendering allocates nothing")
{
    const score s = busy_score();
    for (const format_kind f : all_formats) {
        renderer r(s, f);
        std::vector<std::byte> out(500 * s.channels() * 4);
        const count_allocations count;
        for (std::size_t n = 1; r.position() < s.frames() + 1000; n = n % 500 + 1)
            r.process(std::span(out).first(n * s.channels() * sample_bytes(f)));
        CHECK(count.calls() == 0);
    }
}

COUNTING_TEST_CASE("a mixer allocates nothing after its construction")
{
    const score s = busy_score();
    synth::event_source source(s);
    synth::mixer m(std::vector<double>(9, 1.0), format_kind::s32, 512);
    std::vector<std::byte> out(96 * 9 * 4);
    const count_allocations count;
    for (std::uint32_t round = 0; round < 400; ++round) {
        while (source.peek() != nullptr && m.available() > 0) {
            synth::drive_event e = *source.peek();
            e.score = round % 7;
            m.add(e);
            source.pop();
        }
        m.process(96, out.data());
        if (round % 50 == 20)
            m.fade_out(round % 7, 100 * (round % 3));
    }
    m.reset();
    CHECK(count.calls() == 0);
}

} // namespace placing_test
