// SPDX-License-Identifier: MIT
// Drive time as a value: joining two histories, and time still to come.
#include <doctest/doctest.h>

#include <utility>
#include <vector>

#include "synth/guard/drive_guard.hpp"
#include "synth/guard/drive_history.hpp"

namespace drive_history_values_test {

using tactor::synth::coarsen;
using tactor::synth::drive_guard;
using tactor::synth::drive_history;
using tactor::synth::together;

namespace {

drive_history one_channel(std::vector<drive_history::stretch> stretches, double opens_s = 0.0)
{
    drive_history h;
    h.channels.push_back({std::move(stretches), opens_s});
    return h;
}

void check(const drive_history::stretch& s, double begin_s, double end_s, double driven_s)
{
    CHECK(s.begin_s == doctest::Approx(begin_s));
    CHECK(s.end_s == doctest::Approx(end_s));
    CHECK(s.driven_s == doctest::Approx(driven_s));
}

} // namespace

TEST_CASE("two histories join without counting time twice")
{
    const drive_history a = one_channel({{-9.0, -8.0, 1.0}, {-5.0, -3.0, 0.5}, {-1.0, 0.0, 1.0}}, 0.5);
    const drive_history b = one_channel({{-7.0, -6.0, 0.1}, {-4.0, -2.0, 0.75}, {-0.5, 0.0, 0.5}}, 0.25);
    for (const drive_history& sum : {together(a, b), together(b, a)}) {
        CHECK(sum.channels[0].opens_s == 0.5);
        const auto& s = sum.channels[0].stretches;
        REQUIRE(s.size() == 4);
        check(s[0], -9.0, -8.0, 1.0);
        check(s[1], -7.0, -6.0, 0.1);
        check(s[2], -5.0, -2.0, 1.25);
        check(s[3], -1.0, 0.0, 1.0);
    }
    CHECK(together(a, {}).channels[0].stretches.size() == 3);
    CHECK(together({}, a).channels[0].stretches.size() == 3);
    CHECK(together(a, {}).channels[0].opens_s == 0.5);
    CHECK(together({}, a).channels[0].opens_s == 0.5);
}

TEST_CASE("the elapsed part of the time ahead counts")
{
    drive_history h = one_channel({{-3.0, -2.0, 1.0}});
    h.add_ahead(2, 2.0);
    REQUIRE(h.channels.size() == 2);
    drive_history none = h;
    none.end_now();
    CHECK(none.channels[0].stretches.size() == 1);
    CHECK(none.channels[1].stretches.empty());
    h.pass(0.5);
    h.end_now();
    REQUIRE(h.channels[0].stretches.size() == 2);
    check(h.channels[0].stretches[0], -3.5, -2.5, 1.0);
    check(h.channels[0].stretches[1], -0.5, 0.0, 0.5);
    check(h.channels[1].stretches[0], -0.5, 0.0, 0.5);
    h.add_ahead(1, 1.0); // continues where that ended
    CHECK(h.channels[0].stretches.size() == 3);
    h.pass(5.0);
    h.end_now();
    check(h.channels[0].stretches[2], -5.0, -4.0, 1.0);
}

TEST_CASE("a history is empty where nothing was driven and nothing is cut")
{
    CHECK(drive_history{}.empty());
    CHECK(one_channel({}).empty());
    CHECK(one_channel({}, -0.02).empty());
    CHECK_FALSE(one_channel({}, 0.02).empty());
    CHECK_FALSE(one_channel({{-1.0, 0.0, 0.1}}).empty());
}

TEST_CASE("a coarser history covers the finer one")
{
    drive_history h;
    h.channels.resize(2);
    for (int i = 0; i < 10; ++i)
        h.channels[0].stretches.push_back({i - 10.0, i - 9.5, 0.25});
    h.channels[1].stretches = {{-1.0, 0.0, 1.0}};
    drive_history same = h;
    coarsen(same, 10);
    CHECK(same.channels[0].stretches.size() == 10);
    coarsen(h, 4);
    const auto& s = h.channels[0].stretches;
    REQUIRE(s.size() == 4);
    check(s[0], -10.0, -3.5, 1.75);
    check(s[1], -3.0, -2.5, 0.25);
    check(s[3], -1.0, -0.5, 0.25);
    check(h.channels[1].stretches[0], -1.0, 0.0, 1.0);
    coarsen(h, 1);
    REQUIRE(s.size() == 1);
    check(s[0], -10.0, -0.5, 2.5);
}

TEST_CASE("drive time older than any window is forgotten")
{
    drive_history h = one_channel({{-9.0, -8.0, 1.0}, {-5.0, -3.0, 0.5}, {-1.0, 0.0, 1.0}});
    tactor::synth::forget(h, 8.0);
    REQUIRE(h.channels[0].stretches.size() == 2);
    tactor::synth::forget(h, 3.5);
    CHECK(h.channels[0].stretches.size() == 2);
    tactor::synth::forget(h, 0.0);
    CHECK(h.empty());
}

TEST_CASE("a channel that another guard had cut is closed where it is driven too early")
{
    drive_guard first(2, 500, 1000, 1000);
    CHECK(first.drive(0, 0, 500));
    CHECK_FALSE(first.drive(0, 500, 520));
    drive_guard second(2, 500, 1000, 1000);
    second.resume(first.history(600));
    CHECK(second.drive(1, 0, 100));
    CHECK_FALSE(second.drive(0, 100, 150));
    CHECK_FALSE(second.drive(0, 200, 250));
    drive_guard later(2, 500, 1000, 1000);
    later.resume(first.history(1600));
    CHECK(later.drive(0, 100, 150));
}

TEST_CASE("a channel that was cut for a lower limit is open where a higher one allows it")
{
    drive_guard low(1, 100, 1000, 1000);
    CHECK(low.drive(0, 0, 100));
    CHECK_FALSE(low.drive(0, 100, 150));
    drive_guard high(1, 500, 1000, 1000);
    high.resume(low.history(200));
    CHECK_FALSE(high.acts(0, 0, 10));
    CHECK(high.drive(0, 0, 380)); // and 100, and a fade of 20, were given
    CHECK_FALSE(high.drive(0, 380, 400));
    drive_guard same(1, 100, 1000, 1000);
    same.resume(low.history(200));
    CHECK_FALSE(same.drive(0, 0, 10));
}

TEST_CASE("a driven channel without further history is not faded in")
{
    drive_guard g(1, 500, 1000, 1000);
    g.resume(one_channel({{-0.1, 0.0, 0.1}}));
    CHECK(g.drive(0, 0, 10));
    CHECK_FALSE(g.acts(0, 0, 10));
}

TEST_CASE("drive time that has left the window leaves an empty history")
{
    drive_guard g(2, 500, 1000, 1000);
    g.drive(0, 0, 100);
    g.drive(0, 200, 300);
    CHECK(g.history(1000).channels[0].stretches.size() == 2);
    CHECK(g.history(1099).channels[0].stretches.size() == 2);
    CHECK(g.history(1100).channels[0].stretches.size() == 1);
    CHECK_FALSE(g.history(1299).empty());
    CHECK(g.history(1300).empty());
    CHECK(g.history(0).channels[1].stretches.empty());
}

} // namespace drive_history_values_test
