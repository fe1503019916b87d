// SPDX-License-Identifier: MIT
// Limits on the power of the array and on the time that a tactor is driven.
#include "synth/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "pieces.hpp"
#include "synth/mix/mixer.hpp"

namespace guard_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 8000;

/// Makes bursts (onset, duration) of full scale on the first `tactors` of as many, and silence until
/// `total_s`.
score loud(unsigned tactors, std::vector<std::pair<double, double>> times, double total_s,
           std::optional<drive_limits> limits, double level_dbfs = 0.0)
{
    std::vector<burst> bursts;
    for (const auto& [onset, duration] : times) {
        std::vector<drive> drives;
        for (unsigned i = 0; i < tactors; ++i)
            drives.push_back({i, 1.0});
        bursts.push_back(make_burst(onset, duration, drives));
    }
    plan p = make_plan(std::move(bursts));
    p.total_s = p.stroke_duration_s = total_s;
    render_options o{.rate = rate, .level_dbfs = level_dbfs, .limits = limits};
    return {row(tactors), {{p, {}}}, o};
}

double largest_step(const std::vector<double>& x)
{
    double most = 0.0;
    for (std::size_t i = 1; i < x.size(); ++i)
        most = std::max(most, std::abs(x[i] - x[i - 1]));
    return most;
}

double largest(const std::vector<double>& x, double from_s, double to_s)
{
    double most = 0.0;
    for (auto i = static_cast<std::size_t>(from_s * rate); i < static_cast<std::size_t>(to_s * rate); ++i)
        most = std::max(most, std::abs(x[i]));
    return most;
}

drive_limits no_longest(double power_dbfs)
{
    return {.power_dbfs = power_dbfs, .max_drive_s = 3600.0, .window_s = 10.0};
}

} // namespace

TEST_CASE("a piece within the limits has the same bytes with and without them")
{
    for (const unsigned tactors : {1U, 3U}) {
        const std::vector<std::pair<double, double>> times{{0.0, 2.5}, {3.0, 2.5}};
        for (const format_kind f : all_formats) {
            CHECK((render(loud(tactors, times, 6.0, drive_limits{}), f) ==
                   render(loud(tactors, times, 6.0, {}), f)));
        }
    }
    // Nine at the default level are below the power of three at full scale.
    CHECK((render(loud(9, {{0.0, 1.0}}, 1.0, drive_limits{}, -12.0), format_kind::s32) ==
           render(loud(9, {{0.0, 1.0}}, 1.0, {}, -12.0), format_kind::s32)));
}

TEST_CASE("the gain recovers a while after the loud part")
{
    const score s = loud(9, {{0.0, 0.2}, {1.2, 0.1}}, 1.4, no_longest(4.771212547196624));
    plan quiet = make_plan(
        {make_burst(0.0, 0.2, {{0, 1.0}, {1, 1.0}, {2, 1.0}, {3, 1.0}}), make_burst(1.2, 0.1, {{0, 1.0}})});
    render_options o{.rate = rate, .level_dbfs = 0.0, .limits = no_longest(4.771212547196624)};
    const std::vector<double> x = channel(score(row(4), {{quiet, {}}}, o), 0);
    CHECK(largest(x, 0.05, 0.2) < 0.9);
    CHECK(largest(x, 1.2, 1.3) == doctest::Approx(1.0));
}

TEST_CASE("a tactor may be driven for five seconds, then it fades")
{
    const std::vector<double> five = channel(loud(1, {{1.03, 5.0}}, 8.0, drive_limits{}), 0);
    CHECK((five == channel(loud(1, {{1.03, 5.0}}, 8.0, {}), 0)));

    const std::vector<double> x = channel(loud(1, {{1.03, 20.0}}, 22.0, drive_limits{}), 0);
    CHECK(largest(x, 1.1, 6.02) == doctest::Approx(1.0));
    CHECK(largest(x, 6.06, 8.56) == 0.0); // it rests for 2.52 s, until half of it is left
    CHECK(largest_step(x) <= 2.0 * std::sin(pi * 250.0 / rate) + 1e-3);
    CHECK(largest(x, 8.6, 8.8) == doctest::Approx(1.0));
}

TEST_CASE("an epoch's end does not give a tactor its time back")
{
    drive_limits l{.max_drive_s = 0.5, .window_s = 1.0};
    synth::mixer m(std::vector<double>(1, 1.0), format_kind::float32, 8, synth::make_guards(l, rate));
    synth::drive_event e;
    e.length = e.window = rate;
    e.cycles_per_frame = 250.0 / rate;
    e.drives = 1;
    e.drive[0] = {1.0, 1.0, 0};
    std::vector<float> x(rate);
    for (int epoch = 0; epoch < 2; ++epoch) {
        CHECK(m.add(e));
        m.process(rate / 2 - 100, reinterpret_cast<std::byte*>(x.data()));
        m.reset();
    }
    CHECK(m.counts().drives_cut == 1);
}

TEST_CASE("weak drives do not count, and impossible limits are named")
{
    CHECK((channel(loud(1, {{0.0, 20.0}}, 20.0, drive_limits{}, -41.0), 0) ==
           channel(loud(1, {{0.0, 20.0}}, 20.0, {}, -41.0), 0)));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const drive_limits& l :
         {drive_limits{.power_dbfs = nan}, drive_limits{.max_drive_s = 0.0}, drive_limits{.max_drive_s = nan},
          drive_limits{.window_s = nan}, drive_limits{.window_s = 1e9}, drive_limits{.power_dbfs = -500.0},
          drive_limits{.power_dbfs = 61.0},
          drive_limits{.power_dbfs = std::numeric_limits<double>::infinity()},
          drive_limits{.max_drive_s = 3601.0}})
        CHECK_THROWS_AS(loud(1, {{0.0, 0.1}}, 0.1, l), error);
}

TEST_CASE("non-numbers reach no format")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    for (const format_kind f : all_formats) {
        synth::mixer m(std::vector<double>{1.0, 0.5, nan}, f, 64, synth::make_guards({}, 48000));
        for (const double a : {nan, inf, -inf, 1e308, -1e308, 1e200}) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                synth::drive_event e;
                e.length = e.window = 400;
                e.cycles_per_frame = c == 2 ? nan : 250.0 / 48000.0;
                e.drives = 2;
                e.drive[0] = {a, a, c};
                e.drive[1] = {-a, a, 1};
                m.add(e);
            }
        }
        std::vector<std::byte> out(480 * 3 * sample_bytes(f));
        m.process(480, out.data());
        for (std::size_t i = 0; i < 480 * 3; ++i) {
            if (f == format_kind::float32) {
                const float v = sample<float>(out, i);
                REQUIRE(std::abs(v) <= (i % 3 == 1 ? 0.5F : i % 3 == 2 ? 0.0F : 1.0F));
            } else {
                const auto v = std::abs(static_cast<double>(integer(out, f, i))) / full_scale(f);
                REQUIRE(v <= (i % 3 == 1 ? 0.5 : i % 3 == 2 ? 0.0 : 1.0));
            }
        }
    }
}

} // namespace guard_test
