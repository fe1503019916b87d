// SPDX-License-Identifier: MIT
#include "study/calibrate/result.hpp"

#include <vector>

#include <doctest/doctest.h>

namespace tactor::study::test_doubtful {
namespace {

array row(const std::vector<double>& thresholds_dbfs)
{
    array a;
    for (const double t : thresholds_dbfs) {
        a.tactors.push_back({.position = {10.0 * static_cast<double>(a.tactors.size()), 0.0}});
        a.tactors.back().threshold_dbfs = t;
    }
    return a;
}

TEST_CASE("a threshold more than 12 dB above the array's median is named, one below is not")
{
    const auto found = find_doubtful(row({-45, -44, -32.9, -46, -70}), {}, {});
    REQUIRE(found.size() == 1);
    CHECK(found[0].tactor == 2);
    CHECK(found[0].why == "it is 12.1 dB above the median of the array's (-45.0 dBFS)");
    CHECK(find_doubtful(row({-45, -44, -33, -46, -70}), {}, {}).empty());
    CHECK(find_doubtful(row({-46, -44, -20}), {}, {}).size() == 1);
    CHECK(find_doubtful(row({-46, -44, -32, -30}), {}, {})
              .empty()); // an even number: the mean of the middle two
    CHECK(find_doubtful(row({}), {}, {}).empty());
}

TEST_CASE("tactors without a threshold do not count, and lists are read at the session's carrier")
{
    array a = row({-45, -45, -45, -45, -45});
    a.tactors[0].threshold_dbfs.reset();
    a.tactors[3].threshold_dbfs.reset();
    a.tactors[3].thresholds = {{100.0, -10.0}, {250.0, -45.0}};
    calibration_settings s;
    CHECK(find_doubtful(a, s, {}).empty());
    s.carrier_hz = 100.0;
    REQUIRE(find_doubtful(a, s, {}).size() == 1);
    CHECK(find_doubtful(a, s, {})[0].tactor == 3);
}

TEST_CASE("answers below the threshold that stay right after the second staircase are named")
{
    const std::vector<tactor_threshold> measured{
        {.tactor = 1, .threshold_dbfs = -44.0, .check_below_right = 9, .staircases = 2},
        {.tactor = 0, .threshold_dbfs = -45.0, .check_below_right = 8}};
    const auto found = find_doubtful(row({-45, -44, -46}), {}, measured);
    REQUIRE(found.size() == 1);
    CHECK(found[0].tactor == 1);
    CHECK(found[0].why == "9 of 10 answers 6 dB below it were right, after a second staircase too");
}

} // namespace
} // namespace tactor::study::test_doubtful
