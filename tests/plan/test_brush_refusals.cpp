// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <tactor/plan.hpp>

#include "arrays.hpp"
#include "plan/brush.hpp"
#include "strokes.hpp"

namespace brush_refusals_test {

using namespace tactor;
using namespace tactor::test;

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
        if (why.empty() || why.find("no duration") != std::string::npos)
            continue;
        ++refused;
        const double shortest = number_after(why, "that works is ");
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
    const double shortest = number_after(refusal(palm, fast, o), "that works is ");
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
    CHECK(number_after(why, "that works is ") == doctest::Approx(0.0473));
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

} // namespace brush_refusals_test
