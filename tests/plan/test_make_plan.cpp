// SPDX-License-Identifier: MIT
// Plans: options, strokes that leave the array, targets that ease, change their speed and rest.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>

#include "arrays.hpp"
#include "has.hpp"
#include "rounds.hpp"
#include "strokes.hpp"

namespace make_plan_test {

using namespace tactor;
using namespace tactor::test;

namespace {

/// Returns how far a movement leaves the array, sampled at many places; and the first place outside.
struct excursion {
    double farthest_mm = 0.0;
    double first_s = -1.0;
};

excursion look(const layout& l, const trajectory& t)
{
    excursion e;
    for (int k = 0; k <= 4000; ++k) {
        const double when = t.duration_s() * k / 4000.0;
        const point p = t.position(when);
        const double out = distance_mm(p, l.nearest(p));
        e.farthest_mm = std::max(e.farthest_mm, out);
        if (out > edge_tolerance_mm && e.first_s < 0.0)
            e.first_s = when;
    }
    return e;
}

// Short times have smaller units.
double time_after(const std::string& said)
{
    const double v = number_after(said, "after ");
    const std::string rest = said.substr(said.find("after ") + 6);
    const std::string unit = rest.substr(rest.find(' ') + 1, 2);
    return unit == "us" ? 1e-6 * v : unit == "ns" ? 1e-9 * v : v;
}

stroke moving(std::string_view svg, const movement& m)
{
    return make_stroke(trajectory::along(path::from_svg(svg), m));
}

double minimum_jerk(double u)
{
    return u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
}

const movement jerk{.duration_s = 2.1, .easing = easing_kind::minimum_jerk};
const movement resting{.duration_s = 3.0,
                       .easing = easing_kind::in_out,
                       .speed_mm_s = {{0.0, 1.0}, {1.0, 2.0}},
                       .intensity = {{0.0, 0.2}, {1.0, 0.8}},
                       .rests = {{0.4, 0.6, 0.0}}};

} // namespace

TEST_CASE("a path that leaves the array is refused at the place, or clamped")
{
    plan_options o;
    const stroke out = along("M 0 20 L 100 20", 1.0);
    for (const auto method : all_values<algorithm_kind>()) {
        o.algorithm = method;
        o.outside = outside_kind::error;
        const std::string why = refusal(palm, out, o);
        has(why, "leaves the array at (40.000, 20.000) mm after 0.4 s, and goes 60 mm outside");
        has(why, "outside = clamp");
        has(refusal(palm, along("M -3 20 L 20 20", 1.0), o),
            "starts outside the array, at (-3.000, 20.000) mm, and goes 3 mm outside");
        o.outside = outside_kind::clamp;
        CHECK_NOTHROW(make_plan(palm, out, o));
    }
    o.algorithm = algorithm_kind::park2016;
    const plan p = make_plan(palm, out, o);
    CHECK(p.bursts.back().position == point{40.0, 20.0});
    CHECK(p.bursts.back().drives == std::vector<drive>{{5, 1.0}});
}

TEST_CASE("a stroke's carrier wins over the common one; anything but a frequency is refused")
{
    stroke s = across(1.0);
    plan_options o{.carrier_hz = 200.0};
    CHECK(make_plan(palm, s, o).carrier_hz == 200.0);
    s.sound.carrier_hz = 180.0;
    CHECK(make_plan(palm, s, o).carrier_hz == 180.0);
    s.sound.carrier_hz.reset();
    for (const double hz : {0.0, -250.0, not_a_number, infinite}) {
        o.carrier_hz = hz;
        CHECK(refusal(palm, s, o).starts_with("carrier_hz"));
    }
}

TEST_CASE("an absurd number of bursts is refused at once")
{
    plan_options o{.profile = {0.32, 0.0, 0.07}, .soa_s = 1e-6};
    CHECK(refusal(palm, across(86400.0), o).find("bursts") != std::string::npos);
}

TEST_CASE("a scale defines half an intensity, and is held to its bounds")
{
    const intensity_scale linear;
    for (const double i : {0.0, 0.5, 1.0, 3.0, -1.0})
        CHECK(linear.amplitude(i) == i);
    for (const double exponent : {0.1, 0.6, 3.0}) {
        const intensity_scale s{scale_kind::stevens, exponent};
        CHECK(s.amplitude(0.0) == 0.0);
        CHECK(s.amplitude(1.0) == 1.0);
        CHECK(s.amplitude(0.5) == doctest::Approx(std::pow(0.5, 1.0 / exponent)));
    }
    for (const double db : {0.1, 7.0, 100.0}) {
        const intensity_scale s{.kind = scale_kind::sl, .sl_db = db};
        CHECK(s.amplitude(0.0) == 0.0);
        CHECK(s.amplitude(1.0) == 1.0);
        CHECK(s.amplitude(0.5) == doctest::Approx(std::pow(10.0, -0.5 * db / 20.0)));
    }
    for (intensity_scale s : {linear, intensity_scale{scale_kind::stevens, 0.6},
                              intensity_scale{.kind = scale_kind::sl, .sl_db = 7.0}}) {
        const double plain = s.amplitude(0.5);
        s.level_db = -9.0;
        CHECK(s.amplitude(0.5) == doctest::Approx(plain * std::pow(10.0, -9.0 / 20.0)).epsilon(1e-14));
        CHECK(s.amplitude(0.0) == 0.0);
        for (const double db : {0.01, 28.0, not_a_number, -HUGE_VAL}) {
            s.level_db = db;
            CHECK_THROWS_AS(s.amplitude(0.5), error);
        }
    }
    for (const double exponent : {0.09, 3.01, not_a_number})
        CHECK_THROWS_AS((intensity_scale{scale_kind::stevens, exponent}.amplitude(0.5)), error);
    for (const double db : {0.0, 100.1, not_a_number})
        CHECK_THROWS_AS((intensity_scale{.kind = scale_kind::sl, .sl_db = db}.amplitude(0.5)), error);
}

TEST_CASE("a custom model is used by its name, and held to its contract")
{
    struct nearest final : phantom_model {
        std::vector<drive> answer;
        std::string_view name() const noexcept override { return "mine"; }
        void weights(point, double a_v, std::vector<drive>& out) const override
        {
            out = answer;
            for (drive& d : out)
                d.amplitude *= a_v;
        }
    };
    const auto with = [](std::vector<drive> answer) {
        auto m = std::make_shared<nearest>();
        m->answer = std::move(answer);
        return plan_options{.custom_phantom = m};
    };
    const plan p = make_plan(palm, across(1.0), with({{2, 0.5}, {7, 0.25}}));
    CHECK(p.phantom == "mine");
    CHECK(p.bursts[4].drives == std::vector<drive>{{2, 0.5}, {7, 0.25}});
    for (const std::vector<drive>& wrong :
         {std::vector<drive>{{9, 1.0}}, {{3, 1.0}, {2, 1.0}}, {{3, not_a_number}}, {{3, 0.0}}})
        CHECK_FALSE(refusal(palm, across(1.0), with(wrong)).empty());
}

TEST_CASE("a layout of another array is refused")
{
    CHECK_THROWS_AS(make_plan(palm, layout(preset_array("palm-2x4")), across(1.0), {}), error);
}

TEST_CASE("a continuous plan has no bursts, and the phantom at every time")
{
    plan_options o{.algorithm = algorithm_kind::continuous, .phantom = phantom_kind::barycentric};
    plan p;
    {
        const array a = palm;
        p = make_plan(a, timed({{0.0, {0, 20}, 1.0}, {1.0, {40, 20}, 0.5}}), o);
    }
    CHECK(p.algorithm == "continuous");
    CHECK(p.phantom == "barycentric");
    CHECK(p.bursts.empty());
    CHECK_FALSE(p.soa_s);
    CHECK(p.total_s == 1.0);
    REQUIRE(p.curve);
    burst b{.tau_s = 3.0};
    p.curve->at(0.25, b);
    CHECK(b.onset_s == 0.25);
    CHECK(b.duration_s == 0.0);
    CHECK_FALSE(b.tau_s);
    CHECK(b.position.x_mm == doctest::Approx(10.0));
    CHECK(b.intensity == doctest::Approx(0.875));
    REQUIRE(b.drives.size() == 2);
    CHECK(b.drives[0].tactor == 3);
    CHECK(b.drives[0].amplitude == doctest::Approx(0.875 * std::sqrt(0.5)));
    p.curve->at(99.0, b);
    CHECK(b.drives.size() == 1);
    CHECK(b.onset_s == 1.0);
    p.curve->at(-1.0, b);
    CHECK(b.position == point{0.0, 20.0});
}

TEST_CASE("a way out of five milliseconds is found in a day, to the microsecond")
{
    for (const double duration : {10.0, 2000.0, 86400.0}) {
        for (const double part : {0.1234567, 0.5, 0.987654321}) {
            CAPTURE(duration);
            const double at = duration * part;
            const stroke s = timed({{0.0, {20, 20}},
                                    {at, {20, 35}},
                                    {at + 0.0025, {20, 45}},
                                    {at + 0.005, {20, 35}},
                                    {duration, {20, 20}}});
            const std::string said = refusal(palm, s, continuous());
            CHECK(said.find("leaves the array at (20.000, 40.000) mm after ") != std::string::npos);
            CHECK(number_after(said, "after ") == doctest::Approx(at + 0.00125).epsilon(1e-5));
            plan_options o = continuous();
            o.outside = outside_kind::clamp;
            CHECK(refusal(palm, s, o).empty());
        }
    }
}

TEST_CASE("curves that turn at the edge stay inside, curves that turn beyond it do not")
{
    // A parabola over the upper edge whose top is at y = 0, then a hundredth of a millimetre above.
    CHECK(refusal(palm, along("M 0 20 Q 20 -20 40 20", 86400.0), continuous()).empty());
    const std::string said = refusal(palm, along("M 0 20 Q 20 -20.02 40 20", 86400.0), continuous());
    CHECK(said.find("leaves the array at (19.") != std::string::npos);
    CHECK(
        refusal(palm, along("M 20 0 A 20 20 0 1 1 20 40 A 20 20 0 1 1 20 0", 3600.0), continuous()).empty());
    CHECK_FALSE(refusal(palm, along("M 20 0 A 20.001 20.001 0 1 1 20 40", 3600.0), continuous()).empty());
    // A slanted edge, which no turn of x or y touches.
    const array corner = make_array({{0, 0}, {40, 0}, {0, 40}});
    CHECK(refusal(corner, along("M 30 5 Q 20 24.99 5 30", 1.0), continuous()).empty());
    CHECK_FALSE(refusal(corner, along("M 30 5 Q 30 30 5 30", 1.0), continuous()).empty());
}

TEST_CASE("strokes leave arrays in one line and of one tactor")
{
    const array line = make_array({{30, 30}, {0, 0}, {10, 10}, {20, 20}});
    CHECK(refusal(line, along("M 0 0 L 30 30 L 10 10", 2.0), continuous()).empty());
    CHECK(refusal(line, along("M 5 5 C 10 10 20 20 29 29", 2.0), continuous()).empty());
    CHECK_FALSE(refusal(line, along("M 5 5 C 10 10 70 70 20 20", 2.0), continuous()).empty());
    CHECK_FALSE(refusal(line, along("M 5 5 Q 10 10.1 20 20", 2.0), continuous()).empty());
    CHECK_FALSE(refusal(line, along("M 0 0 L 31 31", 2.0), continuous()).empty());
    const array one = make_array({{3, 4}});
    CHECK_FALSE(refusal(one, along("M 3 4 C 10 4 3 10 3 4", 1.0), continuous()).empty());
    CHECK(refusal(one, timed({{0.0, {3, 4}}, {5.0, {3, 4}}}), continuous()).empty());
}

TEST_CASE("a path within a hundredth of a millimetre of the array is on its edge")
{
    for (const algorithm_kind k : all_values<algorithm_kind>()) {
        plan_options o = continuous();
        o.algorithm = k;
        const auto complaint = [&](double beyond_mm) {
            return refusal(palm, along(fmt::format("M 0 {} H 40", 40.0 + beyond_mm), 1.4), o);
        };
        CHECK(complaint(0.00043).empty());
        CHECK(complaint(0.0099).empty());
        CHECK(complaint(0.0101).find("outside") != std::string::npos);
        const plan p = make_plan(palm, along("M 0 40.00043 H 40", 1.4), o);
        for (const burst& b : p.bursts)
            CHECK(b.position.y_mm == 40.0);
    }
}

TEST_CASE("any curve on any array is refused at a place outside, or never leaves")
{
    std::mt19937_64 random(21);
    std::uniform_real_distribution<double> place(0.0, 40.0);
    int refused = 0;
    int taken = 0;
    for (int n = 0; n < rounds(300); ++n) {
        CAPTURE(n);
        std::vector<point> places;
        for (int i = 0; i < 4 + n % 7; ++i)
            places.push_back({place(random), place(random)});
        const array a = n % 2 == 0 ? palm : make_array(places);
        const layout l(a);
        const auto inside = [&] { return l.nearest({place(random), place(random)}); };
        const auto any = [&] {
            const point p = inside();
            return n % 3 == 0 ? point{1.3 * p.x_mm - 6.0, 1.3 * p.y_mm - 6.0} : p;
        };
        const point p = inside();
        std::string svg = fmt::format("M {} {}", p.x_mm, p.y_mm);
        for (int i = 0; i < 1 + n % 4; ++i) {
            const point b = any();
            const point c = any();
            const point d = any();
            if ((n + i) % 3 == 0)
                svg += fmt::format(" A {} {} {} {} {} {} {}", 1.0 + place(random), 1.0 + place(random), 5 * i,
                                   n % 2, i % 2, d.x_mm, d.y_mm);
            else if ((n + i) % 3 == 1)
                svg += fmt::format(" C {} {} {} {} {} {}", b.x_mm, b.y_mm, c.x_mm, c.y_mm, d.x_mm, d.y_mm);
            else
                svg += fmt::format(" L {} {}", d.x_mm, d.y_mm);
        }
        CAPTURE(svg);
        const stroke s = along(svg, 3.0);
        const excursion e = look(l, s.motion);
        const std::string said = refusal(a, s, continuous());
        if (said.empty()) {
            CHECK(e.farthest_mm < edge_tolerance_mm + 3e-6);
            ++taken;
            continue;
        }
        ++refused;
        if (said.find("starts outside") != std::string::npos)
            continue;
        const double when = time_after(said);
        CHECK((e.first_s < 0.0 || when <= e.first_s + 1e-5));
        const point edge = s.motion.position(when);
        CHECK(distance_mm(edge, l.nearest(edge)) < 0.002); // six digits of the time
    }
    CHECK(refused > rounds(50));
    CHECK(taken > rounds(50));
}

TEST_CASE("bursts of park2016 are at the eased target's place at their onset, with its strength")
{
    const plan p = make_plan(palm, moving("M 0 10 L 40 30", jerk), {});
    REQUIRE(p.bursts.size() == 31);
    for (const burst& b : p.bursts)
        CHECK(std::abs(b.position.x_mm - 40.0 * minimum_jerk(b.onset_s / 2.1)) < 1e-9);
    const stroke s = moving("M 0 10 L 40 30", resting);
    const plan q = make_plan(palm, s, {});
    unsigned silent = 0;
    for (const burst& b : q.bursts) {
        CHECK(b.intensity == s.motion.intensity(b.onset_s));
        silent += b.drives.empty() ? 1 : 0;
    }
    CHECK(silent >= 8); // 0.6 s of rest in silence
    CHECK(silent <= 9);
}

TEST_CASE("the Tactile Brush times its places by the eased target's arrival")
{
    for (const movement& m : {jerk, resting}) {
        const stroke s = moving("M 0 0 H 45", m);
        const plan p = make_plan(arm, s, brush());
        REQUIRE(p.bursts.size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(p.bursts[i].position == point{15.0 * static_cast<double>(i), 0.0});
            CHECK(std::abs(s.motion.position(*p.bursts[i].tau_s).x_mm - p.bursts[i].position.x_mm) < 1e-9);
        }
    }
    const plan p = make_plan(arm, moving("M 0 0 H 45", jerk), brush());
    CHECK(std::abs(minimum_jerk(*p.bursts[1].tau_s / 2.1) - 1.0 / 3.0) < 1e-12);
}

TEST_CASE("the shortest duration that the Tactile Brush names works for eased targets with rests")
{
    stroke s = moving("M 0 0 H 45", resting);
    s.motion = s.motion.with_duration(0.1);
    const double shortest = number_after(refusal(arm, s, brush()), "use at least ");
    REQUIRE(shortest > 0.1);
    s.motion = s.motion.with_duration(shortest);
    CHECK(refusal(arm, s, brush()).empty());
    s.motion = s.motion.with_duration(shortest * 0.999);
    CHECK_FALSE(refusal(arm, s, brush()).empty());
}

TEST_CASE("continuous reports where and when an eased target leaves the array")
{
    const stroke s = moving("M 0 10 C 20 10 60 20 60 30", jerk);
    const std::string why = refusal(palm, s, continuous());
    has(why, "leaves the array at (40.000, ");
    CHECK(std::abs(s.motion.position(number_after(why, "mm after ")).x_mm - 40.0) < 0.1);
}

TEST_CASE("a path that is short compared with the tactors' distance is warned of")
{
    const auto warned = [](std::string_view svg) {
        for (const std::string& w : make_plan(palm, along(svg, 1.0)).warnings)
            if (w.find("people may not feel it move") != std::string::npos)
                return w;
        return std::string();
    };
    CHECK(warned("M 10 10 h 3.9") == "its path of 3.9 mm is shorter than a fifth of the 20 mm between "
                                     "tactors: people may not feel it move");
    CHECK(warned("M 10 10 h 4").empty());
    CHECK(make_plan(palm, timed({{0.0, {10.0, 10.0}}, {1.0, {10.0, 10.0}}})).warnings.empty());
}

TEST_CASE("a movement that no hand makes is asked for its unit, with the factor")
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    const auto warning = [&](const stroke& s) {
        const std::vector<std::string> all = make_plan(palm, s, o).warnings;
        return all.empty() ? std::string() : all.front();
    };
    const auto recorded = [&](std::vector<timed_point> points) {
        return warning(make_stroke(trajectory::timed(std::move(points))));
    };
    // 42.43 mm, the diagonal of 30 mm: in milliseconds, in metres, in micrometres.
    CHECK(
        recorded({{0, {5, 5}}, {1000, {35, 35}}}) ==
        "it moves 42.43 mm in 1000 s, 0.0424 mm/s, slower than a hand: if its times are milliseconds, divide "
        "them by 1000");
    CHECK(recorded({{0, {0.005, 0.005}}, {1, {0.035, 0.02}}}) ==
          "all its places are within 0.035 mm of (0, 0): if they are metres, multiply them by 1000");
    CHECK(recorded({{0, {0, 0}}, {0.005, {40, 0}}}) ==
          "it moves 40 mm in 0.005 s, 8000 mm/s, faster than a hand: if its places are micrometres, divide "
          "them by 1000");
    // 1 mm/s and 5 m/s are those of a hand; so is a minute of rest, or a finger that rests on one place.
    CHECK(recorded({{0, {0, 0}}, {39.9, {40, 0}}}).empty());
    CHECK(recorded({{0, {0, 0}}, {0.008, {40, 0}}}).empty());
    CHECK(recorded({{0, {0, 20}}, {60, {40, 20}}}).empty());
    CHECK(has(recorded({{0, {0, 20}}, {60.1, {40, 20}}}), "slower"));
    CHECK(recorded({{0, {0, 0}}, {1000, {0, 0}}}).empty());
    // A speed has its own factor; rests take no part.
    stroke slow = along("M 0 0 H 40", 40.0 / 0.03);
    slow.speed_mm_s = 0.03;
    CHECK(warning(slow) == "it moves 40 mm in 1333 s, 0.03 mm/s, slower than a hand: if its speed is in m/s, "
                           "multiply it by 1000");
    movement with_rest;
    with_rest.duration_s = 1000.0;
    with_rest.rests = {{0.5, 990.0, 1.0}};
    CHECK(warning(moving("M 0 0 H 40", with_rest)).empty());
}

TEST_CASE("a stroke's choice wins over the common one")
{
    stroke s = along("M 0 10 L 40 30", 1.4);
    s.choices = {{}, phantom_kind::barycentric, 0.06, 0.05};
    const plan p = make_plan(palm, s, {.phantom = phantom_kind::gaussian});
    CHECK(p.phantom == "barycentric");
    CHECK(p.soa_s == 0.06);
    CHECK(p.bursts[0].duration_s == 0.05);
    s.choices.algorithm = algorithm_kind::continuous;
    CHECK(make_plan(palm, s).curve.has_value());
    s.choices.soa_s = 0.02;
    s.choices.algorithm.reset();
    CHECK(refusal(palm, s, {}).find("burst_s: ") == 0);
}

TEST_CASE("a stroke's impossible SOA or burst is refused with its place")
{
    const auto told = [](const char* text, plan_options o = {}) {
        const stroke s = parse_strokes_toml(text, "w.toml").front();
        try {
            static_cast<void>(make_plan(palm, s, o));
        } catch (const error& e) {
            return std::pair<std::string, unsigned>{e.what(), e.place().line};
        }
        return std::pair<std::string, unsigned>{};
    };
    using is = std::pair<std::string, unsigned>;
    const char* soa = "[stroke]\npath = \"M 0 10 H 40\"\nsoa_s = 9\n";
    CHECK(told(soa) == is{"w.toml:3:9: soa_s: 9 s is out of range: the SOA must be above 0.0473 s and at "
                          "most 0.07 s (use 0.07, or set burst_s for a wider range)",
                          3});
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nburst_s = 0.2\n") ==
          is{"w.toml:3:11: burst_s: 0.2 s is longer than the SOA of 0.07 s, and bursts must not "
             "overlap (use at most 0.07 s, or a longer SOA)",
             3});
    // The stroke's SOA is too short for the common duration.
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nsoa_s = 0.05\n", {.burst_s = 0.06}).second == 3);
    // Refuses it for algorithms without an SOA, too.
    for (const algorithm_kind a : {algorithm_kind::tactile_brush, algorithm_kind::continuous})
        CHECK(told(soa, {.algorithm = a}).second == 3);
    // The common value is not the file's fault.
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nburst_s = 0.02\n", {.soa_s = 90.0}).first.find("soa_s: ") ==
          0);
    CHECK(told("[stroke]\npath = \"M 0 10 H 40\"\nsoa_s = 0.05\nburst_s = 0.05\n").second == 0);
}

TEST_CASE("a stroke that asks for a fit is fitted")
{
    stroke s = along("M 100 100 L 900 700", 1.4);
    s.fit = stroke_fit{2.0};
    const plan p = make_plan(palm, s);
    CHECK(p.bursts.front().position.x_mm == doctest::Approx(2.0));
    CHECK(p.bursts.back().position.x_mm == doctest::Approx(38.0));
    const std::vector<stroke> both = apply_fits({s, along("M 0 0 H 10", 1.0)}, layout(palm));
    CHECK_FALSE(both[0].fit);
    CHECK(both[1].motion.length_mm() == 10.0);
    CHECK(make_plan(palm, both[0]) == p);
}

} // namespace make_plan_test
