// SPDX-License-Identifier: MIT
// The Tactile Brush, and the strokes that it refuses.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/plan.hpp>

#include "arrays.hpp"
#include "has.hpp"
#include "plan/job.hpp"
#include "strokes.hpp"

namespace brush_test {

using namespace tactor;
using namespace tactor::test;

namespace {

stroke circle(double duration_s)
{
    return make_stroke(trajectory::along(path::arc({20.0, 20.0}, 20.0, -90.0, 360.0), duration_s));
}

/// Computes the schedule by its equations as first written, not in closed form.
void check_law(const plan& p, const timing_profile& law)
{
    for (std::size_t i = 0; i < p.bursts.size(); ++i) {
        const burst& b = p.bursts[i];
        REQUIRE(b.duration_s >= 0.0);
        REQUIRE(b.tau_s);
        REQUIRE(b.onset_s <= *b.tau_s + 1e-12);
        REQUIRE(b.onset_s + b.duration_s >= *b.tau_s - 1e-9);
        REQUIRE(b.drives.size() <= 2);
        if (i + 1 < p.bursts.size())
            REQUIRE(p.bursts[i + 1].onset_s - b.onset_s ==
                    doctest::Approx(law.slope * b.duration_s + law.intercept_s).epsilon(1e-9));
    }
    REQUIRE(p.bursts.back().onset_s + p.bursts.back().duration_s ==
            doctest::Approx(p.stroke_duration_s).epsilon(1e-12));
    REQUIRE(p.bursts.front().onset_s == 0.0);
}

} // namespace

TEST_CASE("Tactile Brush: the check value of the rendering model, to a microsecond")
{
    const plan p = make_plan(arm, along("M 10 30 L 45 10", 1.0), brush());
    const double onset[] = {0.0, 0.070465, 0.245294, 0.482543, 0.708659};
    const double duration[] = {0.072392, 0.398526, 0.593592, 0.558798, 0.291341};
    REQUIRE(p.bursts.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
        CHECK(std::abs(p.bursts[i].onset_s - onset[i]) < 1e-6);
        CHECK(std::abs(p.bursts[i].duration_s - duration[i]) < 1e-6);
    }
    CHECK(p.algorithm == "tactile-brush");
    CHECK_FALSE(p.soa_s);
    CHECK(std::abs(p.total_s - 1.041341) < 1e-6); // the fourth burst outlasts the stroke
    CHECK(p.dropped.empty());
    CHECK(p.bursts[1].position.x_mm == 15.0);
    REQUIRE(p.warnings.size() == 1);
    CHECK(p.warnings[0] == "4 of 5 bursts last longer than 0.160 s (up to 0.594 s), beyond the range for "
                           "which the timing law was fitted");
    check_law(p, {});
}

TEST_CASE("the law holds and the last burst ends with the stroke, for any path, time and profile")
{
    generator g(31);
    unsigned planned = 0;
    for (unsigned i = 0; i < 1000; ++i) {
        const array a =
            make_grid("g", pick(g, 2, 5), pick(g, 2, 5), between(g, 10.0, 30.0), between(g, 10.0, 30.0));
        const layout l(a);
        std::vector<point> corners;
        for (unsigned k = 0; k < pick(g, 2, 5); ++k)
            corners.push_back(some_point(g, l));
        if (corners.size() < 2 || distance_mm(corners[0], corners[1]) < 1.0)
            continue;
        plan_options o = brush();
        o.snap = true;
        o.drop_points = i % 2 == 0;
        o.profile = {between(g, 0.1, 0.9), between(g, 0.0, 0.06), 0.07};
        const stroke s = make_stroke(trajectory::along(path::polyline(corners), between(g, 0.1, 3.0)));
        const std::string why = refusal(a, s, o);
        if (!why.empty()) {
            REQUIRE(why.find("too short for the Tactile Brush") != std::string::npos);
            continue;
        }
        ++planned;
        check_law(make_plan(a, l, s, o), o.profile);
    }
    CHECK(planned > 300);
}

TEST_CASE("a path along a grid line meets only the other lines")
{
    const plan p = make_plan(palm, along("M 5 20 L 35 20", 1.0), brush());
    REQUIRE(p.bursts.size() == 3);
    CHECK(p.bursts[1].position == point{20.0, 20.0});
    CHECK(p.bursts[0].drives.size() == 2);
}

TEST_CASE("where the path turns from one line onto another it crosses both")
{
    const auto tactors = [](const stroke& s) {
        std::vector<unsigned> all;
        for (const burst& b : make_plan(palm, s, brush()).bursts) {
            REQUIRE(b.drives.size() == 1);
            all.push_back(b.drives[0].tactor);
        }
        return all;
    };
    using list = std::vector<unsigned>;
    CHECK(tactors(along("M 0 20 H 20 V 0", 2.0)) == list{3, 4, 1});
    CHECK(tactors(along("M 0 0 H 40 V 40", 2.0)) == list{0, 1, 2, 5, 8});
    CHECK(tactors(along("M 0 0 H 20 V 40", 2.0)) == list{0, 1, 4, 7});
    CHECK(tactors(along("M 0 0 H 40 V 40 H 0 Z", 4.0)) == list{0, 1, 2, 5, 8, 7, 6, 3, 0});
    CHECK(tactors(timed({{0.0, {0, 0}}, {1.0, {40, 0}}, {2.0, {40, 40}}})) == list{0, 1, 2, 5, 8});
    // Through the same tactor again, after a rest, and with a corner that no line meets.
    CHECK(tactors(along("M 0 20 H 20 V 0 H 40 V 20 H 20 V 40", 4.0)) == list{3, 4, 1, 2, 5, 4, 7});
    CHECK(tactors(timed({{0.0, {0, 20}}, {1.0, {20, 20}}, {1.5, {20, 20}}, {3.0, {20, 0}}})) ==
          list{3, 4, 1});
    CHECK(make_plan(palm, along("M 0 10 H 20 V 30 H 40", 4.0), brush()).bursts.size() == 3);
    const plan p = make_plan(palm, along("M 0 20 H 20 V 0", 2.0), brush());
    CHECK(*p.bursts[1].tau_s == 1.0);
    CHECK(p.bursts[1].position == point{20.0, 20.0});
    CHECK(std::abs(p.bursts[1].onset_s - 0.278258) < 1e-6);
    CHECK(std::abs(p.bursts[1].duration_s - 1.815291) < 1e-6);
}

TEST_CASE("a closed path starts and ends at one place, and both play")
{
    const plan p = make_plan(palm, circle(4.0), brush());
    REQUIRE(p.bursts.size() == 5);
    const unsigned expected[] = {1, 5, 7, 3, 1};
    for (unsigned i = 0; i < 5; ++i) {
        CAPTURE(i);
        REQUIRE(p.bursts[i].drives.size() == 1);
        CHECK(p.bursts[i].drives[0].tactor == expected[i]);
        CHECK(*p.bursts[i].tau_s == doctest::Approx(i).epsilon(1e-6));
    }
    // A place that is left and met again counts twice.
    CHECK(
        make_plan(palm, along("M 10 0 L 20 10 L 30 5 L 30 15 L 20 10 L 10 20", 4.0), brush()).bursts.size() ==
        4);
    // A loop inside one cell meets nothing else.
    CHECK(make_plan(palm, along("M 0 10 L 10 5 L 10 15 Z", 2.0), brush()).bursts.size() == 2);
}

TEST_CASE("a target that rests where it starts, crosses or ends is there once")
{
    const auto p = make_plan(palm,
                             timed({{0.0, {0, 0}},
                                    {1.0, {0, 0}},
                                    {2.0, {20, 20}},
                                    {3.0, {20, 20}},
                                    {4.0, {40, 40}},
                                    {5.0, {40, 40}}}),
                             brush());
    REQUIRE(p.bursts.size() == 3);
    CHECK(*p.bursts[1].tau_s == doctest::Approx(2.0));
    CHECK(*p.bursts[2].tau_s == 5.0);
}

TEST_CASE("a start or end off the grid is refused with the nearest point on it; snap moves it there")
{
    plan_options o = brush();
    const std::string start = refusal(palm, along("M 3 8 L 20 20", 1.0), o);
    CHECK(start.find("starts at (3.000, 8.000) mm") != std::string::npos);
    CHECK(start.find("(0.000, 8.000) mm") != std::string::npos);
    CHECK(start.find("snap = true") != std::string::npos);
    const std::string end = refusal(palm, along("M 0 20 L 33 12", 1.0), o);
    CHECK(end.find("ends at (33.000, 12.000) mm") != std::string::npos);
    CHECK(end.find("(40.000, 12.000) mm") != std::string::npos);
    o.snap = true;
    const plan p = make_plan(palm, along("M 3 8 L 20 20", 1.0), o);
    CHECK(p.bursts[0].position == point{0.0, 8.0});
    CHECK(p.bursts[0].tau_s == 0.0);
    // Snapped onto the line that it crosses at once: one place.
    const plan q = make_plan(palm, along("M 10 21 L 10 0", 1.0), o);
    REQUIRE(q.bursts.size() == 2);
    CHECK(q.bursts[0].position == point{10.0, 20.0});
}

TEST_CASE("conflicts of bursts inside one another, one after the other, and side by side")
{
    const auto sounds = [](unsigned tactor, double from, double to) {
        return burst{.onset_s = from, .duration_s = to - from, .drives = {{tactor, 1.0}}};
    };
    const auto found =
        detail::find_conflicts({sounds(3, 0.0, 1.0), sounds(2, 0.05, 0.3), sounds(3, 0.1, 0.5),
                                sounds(2, 0.1, 0.2), sounds(3, 0.2, 0.3), sounds(3, 0.7, 0.8),
                                sounds(3, 0.8, 1.2), sounds(2, 0.3, 0.4), sounds(3, 1.2 - 1e-10, 1.4)});
    REQUIRE(found.size() == 3);
    CHECK(found[0].tactor == 2);
    CHECK(found[0].from_s == doctest::Approx(0.1));
    CHECK(found[0].to_s == doctest::Approx(0.2));
    CHECK(found[1].tactor == 3);
    CHECK(found[1].from_s == doctest::Approx(0.1));
    CHECK(found[1].to_s == doctest::Approx(0.5));
    CHECK(found[2].from_s == doctest::Approx(0.7));
    CHECK(found[2].to_s == doctest::Approx(1.0));
}

TEST_CASE("the array must be a grid; a single row is one")
{
    has(refusal(make_ring(5, 20.0, true), along("M 0 0 L 10 0", 1.0), brush()), "grid");
    CHECK(make_plan(make_grid("row", 1, 5, 10.0, 10.0), along("M 5 0 L 40 0", 2.0), brush()).bursts.size() ==
          5);
}

TEST_CASE("a path that leaves between two crossings is refused; clamped it stays at the edge")
{
    plan_options o = brush();
    const stroke out = along("M 0 20 C 0 20 20 -30 40 20", 3.0);
    CHECK(refusal(palm, out, o).find("leaves the array") != std::string::npos);
    o.outside = outside_kind::clamp;
    const plan p = make_plan(palm, out, o);
    for (const burst& b : p.bursts)
        CHECK(layout(palm).contains(b.position));
    // Round the corner outside: the corner plays once.
    const plan q = make_plan(palm, along("M 20 0 L 45 -5 L 45 20", 3.0), o);
    unsigned corner = 0;
    for (const burst& b : q.bursts)
        corner += b.position == point{40.0, 0.0} ? 1 : 0;
    CHECK(corner == 1);
}

TEST_CASE("an impossible timing is refused with the shortest duration that works, exact to a microsecond")
{
    generator g(32);
    unsigned refused = 0;
    for (unsigned i = 0; i < 500; ++i) {
        plan_options o = brush();
        o.snap = true;
        std::vector<point> corners;
        for (unsigned k = 0; k < 4; ++k)
            corners.push_back({between(g, 0.0, 45.0), between(g, 0.0, 30.0)});
        const double duration = between(g, 0.01, 0.5);
        const auto at = [&](double t) { return make_stroke(trajectory::along(path::polyline(corners), t)); };
        const std::string why = refusal(arm, at(duration), o);
        if (why.empty() || why.find("all durations") != std::string::npos)
            continue;
        ++refused;
        const double shortest = number_after(why, "use at least ");
        CAPTURE(why);
        REQUIRE(why.find("drop_points = true") != std::string::npos);
        REQUIRE(shortest > duration);
        REQUIRE(refusal(arm, at(shortest), o).empty());
        REQUIRE_FALSE(refusal(arm, at(shortest - 1e-6), o).empty());
    }
    CHECK(refused > 300);
}

TEST_CASE("the shortest duration of a timed stroke scales all its times")
{
    const plan_options o = brush();
    const stroke s = timed({{0.0, {0, 0}}, {0.1, {20, 0}}, {1.0, {40, 0}}});
    const stroke fast = make_stroke(s.motion.with_duration(0.2));
    const double shortest = number_after(refusal(palm, fast, o), "use at least ");
    REQUIRE(shortest > 0.2);
    CHECK(refusal(palm, make_stroke(s.motion.with_duration(shortest)), o).empty());
    CHECK_FALSE(refusal(palm, make_stroke(s.motion.with_duration(shortest - 1e-6)), o).empty());
}

TEST_CASE("drop-points leaves out the place with the smallest gap, the first of ties, until it works")
{
    // By hand: at 50, 60 and 70 ms the smaller gap is 10 ms each, so 50 goes, then 60; 70 can stay.
    // first, ...
    const timing_profile law;
    CHECK(detail::thin_out(law, {0.0, 0.05, 0.06, 0.07, 0.2}) == std::vector<std::size_t>{0, 3, 4});
    CHECK(detail::thin_out(law, {0.0, 0.06, 0.12, 0.2}) == std::vector<std::size_t>{0, 1, 2, 3});
    CHECK(detail::thin_out(law, {0.0, 0.01, 0.02}) == std::vector<std::size_t>{0, 2});

    // Against the rule done naively.
    generator g(33);
    for (unsigned i = 0; i < 2000; ++i) {
        std::vector<double> tau{0.0};
        for (unsigned k = 0; k < pick(g, 2, 20); ++k)
            tau.push_back(tau.back() + 0.005 * pick(g, 1, 40));
        std::vector<std::size_t> left(tau.size());
        for (std::size_t k = 0; k < left.size(); ++k)
            left[k] = k;
        const auto times = [&] {
            std::vector<double> t;
            for (const std::size_t k : left)
                t.push_back(tau[k]);
            return t;
        };
        while (left.size() > 2 && detail::parts_s(law, times()).empty()) {
            std::size_t worst = 1;
            const auto gap = [&](std::size_t k) {
                return std::llround(
                    1e9 * std::min(tau[left[k]] - tau[left[k - 1]], tau[left[k + 1]] - tau[left[k]]));
            };
            for (std::size_t k = 2; k + 1 < left.size(); ++k)
                if (gap(k) < gap(worst))
                    worst = k;
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(worst));
        }
        REQUIRE(detail::thin_out(law, tau) == left);
    }
}

TEST_CASE("dropped points are reported")
{
    plan_options o = brush();
    const stroke s = along("M 0 18 L 40 22", 0.15);
    CHECK_FALSE(refusal(palm, along("M 0 18 L 22 40", 0.06), o).empty());
    o.drop_points = true;
    const plan p = make_plan(palm, along("M 0 18 L 22 40", 0.06), o);
    CHECK(p.dropped.size() + p.bursts.size() == 4);
    REQUIRE_FALSE(p.dropped.empty());
    CHECK(p.warnings.at(0).find(fmt::format("{} of 4", p.dropped.size())) != std::string::npos);
    for (const meeting& m : p.dropped)
        CHECK(distance_mm(m.position, along("M 0 18 L 22 40", 0.06).motion.position(m.t_s)) < 1e-6);
    // Even both ends alone need the intercept of the law.
    const std::string why = refusal(palm, along("M 0 18 L 22 40", 0.04), o);
    CHECK(number_after(why, "use at least ") == doctest::Approx(0.0473));
    CHECK(why.find("drop_points = true") == std::string::npos);
    CHECK(make_plan(palm, s, o).dropped.empty());
}

TEST_CASE("dropping does not take quadratic time")
{
    std::vector<double> tau{0.0};
    for (unsigned i = 0; i < 200000; ++i)
        tau.push_back(tau.back() + (i % 3 == 0 ? 0.01 : 0.03));
    CHECK(detail::thin_out({}, tau).size() < tau.size());
}

} // namespace brush_test
