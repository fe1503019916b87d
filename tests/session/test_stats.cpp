// SPDX-License-Identifier: MIT
// Counters of several streams, one after the other.
#include <vector>

#include <doctest/doctest.h>

#include "session/device_stream.hpp"

namespace stats_test {

using namespace tactor;

namespace {

player_stats one_of_each(double scale)
{
    const auto n = static_cast<std::uint64_t>(scale);
    player_stats s;
    s.periods = s.frames = s.xruns = s.limited_frames = s.power_limited_frames = s.drives_cut = s.stalls = n;
    s.off_failures = s.sync_pulses = s.sync_missed = s.minor_faults = s.major_faults = n;
    s.ring_low_water = n;
    s.sync_mean_late_s = s.sync_worst_late_s = s.latest_wakeup_s = scale;
    s.realtime = true;
    s.xrun_s = {scale};
    return s;
}

} // namespace

TEST_CASE("counters add up, and the worst value stays the worst")
{
    player_stats sum;
    session::add_stats(sum, one_of_each(3));
    session::add_stats(sum, one_of_each(1));
    for (const std::uint64_t n :
         {sum.periods, sum.frames, sum.xruns, sum.limited_frames, sum.power_limited_frames, sum.drives_cut,
          sum.stalls, sum.off_failures, sum.sync_pulses, sum.sync_missed, sum.minor_faults, sum.major_faults})
        CHECK(n == 4);
    CHECK(sum.ring_low_water == 1);
    CHECK(sum.sync_worst_late_s == 3.0);
    CHECK(sum.latest_wakeup_s == 3.0);
    CHECK(sum.sync_mean_late_s == doctest::Approx(2.5)); // of three pulses 3 s, of one 1 s
    CHECK(sum.xrun_s == std::vector<double>{3.0, 1.0});
}

TEST_CASE("one stream without real time makes the sum one without")
{
    player_stats sum;
    session::add_stats(sum, one_of_each(1));
    CHECK(sum.realtime);
    player_stats without = one_of_each(1);
    without.realtime = false;
    session::add_stats(sum, without);
    session::add_stats(sum, one_of_each(1));
    CHECK_FALSE(sum.realtime);
}

TEST_CASE("the newest 64 xruns keep their lengths")
{
    player_stats sum;
    for (int i = 0; i < 100; ++i)
        session::add_stats(sum, one_of_each(i + 1.0));
    REQUIRE(sum.xrun_s.size() == 64);
    CHECK(sum.xrun_s.front() == 37.0);
    CHECK(sum.xrun_s.back() == 100.0);
}

} // namespace stats_test
