// SPDX-License-Identifier: MIT
// Bounds on the demand of continuous strokes on tactors, for any length.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/phantom.hpp>
#include <tactor/render.hpp>

#include "own_curve.hpp"
#include "pieces.hpp"
#include "synth/score/continuous_peaks.hpp"

namespace continuous_peaks_test {

using namespace tactor;

namespace {

const array palm = preset_array("palm-3x3");

/// \param level_db the stroke's own level, which takes it above intensity 1
plan continuous(std::vector<timed_point> points, double level_db, plan_options o = {})
{
    o.algorithm = algorithm_kind::continuous;
    return make_plan(palm,
                     {.motion = trajectory::timed(std::move(points)), .choices = {.level_db = level_db}}, o);
}

/// Hides everything of a plan except its values.
plan opaque(plan p)
{
    p.curve = test::make_curve(p.stroke_duration_s, [c = *p.curve](double t, burst& out) { c.at(t, out); });
    return p;
}

std::string refusal(std::vector<placed_plan> plans, double level_dbfs)
{
    render_options o;
    o.level_dbfs = level_dbfs;
    try {
        score(palm, std::move(plans), o);
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        return e.what();
    }
    return {};
}

/// Makes intensity 0.0005 over the array, except for 8 ms round a time.
std::vector<timed_point> with_spike(double duration_s, double at_s, double intensity)
{
    const auto place = [&](double t) { return point{40.0 * t / duration_s, 20.0}; };
    std::vector<timed_point> points{{0.0, place(0.0), 0.0005}};
    for (const auto& [off, i] : {std::pair{-0.004, 0.0005}, {0.0, intensity}, {0.004, 0.0005}})
        points.push_back({at_s + off, place(at_s + off), i});
    points.push_back({duration_s, place(duration_s), 0.0005});
    return points;
}

} // namespace

TEST_CASE("a spike of 8 ms is found in strokes of ten seconds to a day, and accepted where it does no harm")
{
    std::mt19937_64 random(11);
    for (const double duration : {10.0, 1048.0, 1049.0, 2000.0, 3600.0, 86400.0}) {
        for (int n = 0; n < (duration > 5000.0 ? 1 : duration > 100.0 ? 3 : 20); ++n) {
            std::uniform_int_distribution<int> ms(5, static_cast<int>(duration * 1000.0) - 5);
            const double at = ms(random) * 0.001;
            CAPTURE(duration);
            CAPTURE(at);
            const plan p = continuous(with_spike(duration, at, 1.0), 60.0);
            CHECK(refusal({{p, {}}}, -40.0).find("dBFS, above full scale (0 dBFS)") != std::string::npos);
            CHECK(refusal({{p, {}}}, -60.0).empty());
        }
    }
    // On a tactor that one gets the whole amplitude, and the message has the value.
    const plan p = continuous(with_spike(3600.0, 1800.0, 1.0), 60.0);
    CHECK(refusal({{p, {}}}, -40.0).find("tactor 4: would be driven at 20 dBFS, above full scale") !=
          std::string::npos);
}

TEST_CASE("a plan is left unseen only where its intensity is above no limit: as if every point was looked at")
{
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double stronger_db = 20.0 * std::log10(1.7);
    int refused = 0;
    for (int n = 0; n < 120; ++n) {
        CAPTURE(n);
        std::vector<timed_point> points;
        for (double t = 0.0; t < 1.0 + unit(random); t += 1e-4 + 0.2 * std::pow(unit(random), 3.0))
            points.push_back({t, {40.0 * unit(random), 40.0 * unit(random)}, unit(random)});
        points.push_back({2.5, {20.0, 20.0}, 0.0});
        plan_options o;
        o.phantom = static_cast<phantom_kind>(n % 5);
        plan p = continuous(points, stronger_db, o);
        if (n % 3 == 0) {
            const stroke s{.motion = trajectory::timed(points).with_duration(0.7).with_intensity(0.9),
                           .choices = {.level_db = stronger_db}};
            o.algorithm = algorithm_kind::continuous;
            p = make_plan(palm, s, o);
        }
        const double level = -6.0 * unit(random);
        const std::string said = refusal({{p, {}}}, level);
        CHECK(said == refusal({{opaque(p), {}}}, level));
        refused += said.empty() ? 0 : 1;
    }
    CHECK(refused > 20);
    CHECK(refused < 100);
}

TEST_CASE("a stroke with a spike that no tactor alone could have is played where two share it")
{
    // On a diagonal; harmless before and after.
    const plan p = continuous({{0.0, {0.0, 10.0}, 0.25},
                               {5.0, {10.0, 10.0}, 0.25},
                               {5.1, {10.0, 10.0}, 0.65},
                               {5.2, {10.0, 10.0}, 0.25},
                               {10.0, {40.0, 10.0}, 0.25}},
                              20.0 * std::log10(2.0));
    CHECK(refusal({{p, {}}}, 0.0).empty());
    const std::vector<double> peaks = synth::continuous_peaks(p, 9);
    CHECK(peaks[0] == doctest::Approx(1.3 / std::sqrt(2.0)));
    CHECK(peaks[8] == 0.0);
    CHECK(synth::continuous_bounds(p, 9) == std::vector<double>(9, 1.3));
}

TEST_CASE("a plan for a larger array is looked at, and refused where it drives a tactor that is not there")
{
    const array wide = make_grid("wide", 3, 4, 20.0, 20.0);
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    const auto down = [&](double to_mm) {
        return make_plan(wide, {"", trajectory::timed({{0.0, {1.0, 1.0}}, {10.0, {1.0, to_mm}}})}, o);
    };
    CHECK(synth::continuous_bounds(down(9.0), 9).empty());
    CHECK(refusal({{down(9.0), {}}}, -12.0).empty());
    CHECK(refusal({{down(39.0), {}}}, -12.0).find("cannot be rendered") != std::string::npos);
}

TEST_CASE("every control point of a program's plan is evaluated")
{
    std::uint64_t looks = 0;
    double spike_s = 0.0;
    plan p;
    p.total_s = p.stroke_duration_s = 1500.0;
    p.curve = test::make_curve(1500.0, [&](double t, burst& out) {
        ++looks;
        out.drives = {{3, std::abs(t - spike_s) < 0.0005 ? 1000.0 : 0.5}};
    });
    spike_s = -1.0;
    CHECK(refusal({{p, {}}}, -40.0).empty());
    CHECK(looks >= 1'500'001);
    for (const double at : {0.0, 0.001, 1048.577, 1499.999, 1500.0}) {
        CAPTURE(at);
        spike_s = at;
        CHECK(refusal({{p, {}}}, -40.0).find("tactor 3: would be driven at 20 dBFS") != std::string::npos);
    }
}

TEST_CASE("strokes that are harmless alone are added up where they overlap, even after hours")
{
    for (const double rest : {1.0, 5000.0, 80000.0}) {
        CAPTURE(rest);
        // Silent for long, then a second on the middle tactor.
        const plan late = continuous({{0.0, {20.0, 20.0}, 0.0},
                                      {rest, {20.0, 20.0}, 0.0},
                                      {rest + 0.5, {20.0, 20.0}, 0.7},
                                      {rest + 1.0, {20.0, 20.0}, 0.0}},
                                     0.0);
        const auto with = [&](double amplitude, double at) {
            plan p = pieces::make_plan({pieces::make_burst(0.0, 0.07, {{4, amplitude}})});
            return refusal({{late, 0.0}, {p, at}}, 0.0);
        };
        CHECK(with(0.29, rest).empty());
        CHECK(with(0.31, rest).find("tactor 4: would be driven at 0.08") != std::string::npos);
        CHECK(with(0.31, 0.1).find("tactor 4") != std::string::npos); // both last on at once: taken together
        CHECK(with(0.99, rest + 1.0).empty());
    }
}

} // namespace continuous_peaks_test
