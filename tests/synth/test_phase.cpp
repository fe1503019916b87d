// SPDX-License-Identifier: MIT
// The start of the carrier's phase: its effect on the spectrum, on the mean and on the default ramp.
#include <cmath>
#include <complex>
#include <numeric>

#include <doctest/doctest.h>

#include "pieces.hpp"

namespace phase_test {

using namespace tactor;
using namespace pieces;

namespace {

/// Makes forty bursts of 70 ms in a row on tactor 0, equally strong: 2.8 s.
plan row_of_bursts(double carrier_hz = 250.0, double soa_s = 0.07)
{
    std::vector<burst> bursts;
    for (int k = 0; k < 40; ++k)
        bursts.push_back(make_burst(k * soa_s, soa_s, {{0, 1.0}}));
    return make_plan(std::move(bursts), carrier_hz);
}

render_options full_scale(const render_options& from = {})
{
    render_options o = from;
    o.level_dbfs = 0.0;
    return o;
}

/// Returns the amplitude of the line at hz in dB; the length must be a whole number of its cycles.
double line_db(const std::vector<double>& x, double hz, double rate = 48000.0)
{
    std::complex<double> sum = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double angle = 2.0 * pi * hz * static_cast<double>(k) / rate;
        sum += x[k] * std::complex<double>(std::cos(angle), -std::sin(angle));
    }
    return 20.0 * std::log10(2.0 * std::abs(sum) / static_cast<double>(x.size()) + 1e-12);
}

double mean(const std::vector<double>& x)
{
    return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

constexpr double split_hz =
    1.0 / (2.0 * 0.07); // 250 Hz flipped each 70 ms: half of 1 / 0.07 s to either side

} // namespace

TEST_CASE("a tactor that plays burst after burst has its carrier's line, no other, and no mean")
{
    const score s(row(1), {{row_of_bursts(), {}}}, full_scale());
    const auto x = channel(s, 0);
    REQUIRE(x.size() == 134400);
    CHECK(line_db(x, 250.0) == doctest::Approx(0.0).epsilon(0.001));
    CHECK(line_db(x, 250.0 - split_hz) < -100.0);
    CHECK(line_db(x, 250.0 + split_hz) < -100.0);
    CHECK(std::abs(mean(x)) < 1e-9);
}

TEST_CASE("a restart at each burst splits the line in two and leaves a mean")
{
    render_options o = full_scale();
    o.phase = phase_kind::burst;
    const score s(row(1), {{row_of_bursts(), {}}}, o);
    const auto x = channel(s, 0);
    CHECK(line_db(x, 250.0) < -30.0);
    CHECK(line_db(x, 250.0 - split_hz) > -6.0);
    CHECK(line_db(x, 250.0 + split_hz) > -6.0);
    CHECK(mean(x) > 0.01);
}

TEST_CASE("the carrier counts from its stroke's first frame, at any start")
{
    // 240 Hz: no burst except the first begins on a crossing, so each sample depends on the count.
    const double hz = 240.0;
    plan p = make_plan({make_burst(0.011, 0.1, {{0, 0.6}}), make_burst(0.17, 0.05, {{0, 0.5}})}, hz);
    for (const double start_s : {0.0, 0.2501}) {
        render_options o = full_scale();
        o.ramp_s = 0.0;
        const score s(row(1), {{p, start_s}}, o);
        const auto x = channel(s, 0);
        const std::size_t first = s.starts()[0];
        for (std::size_t k = first; k < x.size(); ++k) {
            const std::size_t at = k - first;
            const double a = at >= 528 && at < 5328 ? 0.6 : (at >= 8160 ? 0.5 : 0.0);
            const double exact = a * std::sin(2.0 * pi * hz * static_cast<double>(at) / 48000.0);
            REQUIRE(std::abs(x[k] - exact) < 1e-6);
        }
    }
}

TEST_CASE("overlapping bursts continue the stroke's carrier")
{
    const double hz = 240.0;
    const plan p = make_plan({make_burst(0.011, 0.1, {{0, 0.6}}), make_burst(0.06, 0.1, {{0, 0.5}})}, hz);
    render_options o = full_scale();
    o.ramp_s = 0.0;
    const auto x = channel(score(row(1), {{p, 0.2501}}, o), 0);
    const std::size_t first = 12005;
    for (std::size_t at = 528; at < 2880; ++at) {
        const double exact = 0.6 * std::sin(2.0 * pi * hz * static_cast<double>(at) / 48000.0);
        REQUIRE(std::abs(x[first + at] - exact) < 1e-6);
    }
}

TEST_CASE("a burst has no ramp where the carrier crosses zero at both its ends, else 2 ms")
{
    // From the stroke's start in half cycles of 2 ms; 0.02 ms is 1 % of one.
    struct example {
        double onset_s;
        double duration_s;
        bool ramped;
        bool ramped_alone; ///< where the carrier restarts
    };
    const example all[] = {
        {0.0, 0.07, false, false},      {0.070, 0.07, false, false},     {0.07001, 0.07, false, false},
        {0.0705, 0.07, true, false},    {0.0705, 0.0695, true, true},    {0.0, 0.0705, true, true},
        {0.07, 0.000019, true, true},   {0.0700195, 0.0, true, true},    {0.07003, 0.07, true, false},
        {0.070, 0.06999, false, false}, {0.07001, 0.07002, true, false},
    };
    for (const example& e : all) {
        for (const phase_kind phase : {phase_kind::stroke, phase_kind::burst}) {
            render_options o = full_scale();
            o.rate = 768000;
            o.phase = phase;
            const plan p = make_plan({make_burst(e.onset_s, e.duration_s, {{0, 1.0}})});
            const auto x = channel(score(row(1), {{p, {}}}, o), 0);
            const bool expected = phase == phase_kind::stroke ? e.ramped : e.ramped_alone;
            const auto first = static_cast<std::size_t>(std::llround(e.onset_s * o.rate));
            const std::size_t quarter = first + 768; // 1 ms, half way up a ramp of 2 ms
            if (quarter + 768 >= x.size())
                continue; // the shortest ones only have to be accepted
            CAPTURE(e.onset_s);
            CAPTURE(e.duration_s);
            CAPTURE(static_cast<int>(phase));
            const double from = phase == phase_kind::stroke ? static_cast<double>(quarter) : 768.0;
            const double carrier = std::sin(2.0 * pi * 250.0 * from / o.rate);
            CHECK(x[quarter] / carrier == doctest::Approx(expected ? 0.5 : 1.0).epsilon(0.01));
        }
    }
}

TEST_CASE("an explicit ramp wins in either phase")
{
    for (const phase_kind phase : {phase_kind::stroke, phase_kind::burst}) {
        render_options o = full_scale();
        o.phase = phase;
        o.ramp_s = 0.002;
        const auto ramped = channel(score(row(1), {{row_of_bursts(), {}}}, o), 0);
        CHECK(ramped[48] == doctest::Approx(0.5));
        o.ramp_s = 0.0;
        const auto plain = channel(score(row(1), {{row_of_bursts(255.0), {}}}, o), 0);
        CHECK(plain[47] == doctest::Approx(std::sin(2.0 * pi * 255.0 * 47.0 / 48000.0)));
    }
}

TEST_CASE("phases have names")
{
    CHECK(to_string(phase_kind::stroke) == "stroke");
    CHECK(to_string(phase_kind::burst) == "burst");
    CHECK(render_options{}.phase == phase_kind::stroke);
}

} // namespace phase_test
