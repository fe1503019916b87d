// SPDX-License-Identifier: MIT
#include "amplifier/line.hpp"

#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace debounce_test {

using tactor::amplifier::debounce;

namespace {

std::vector<bool> filter(std::int64_t window, const std::vector<std::int64_t>& times)
{
    debounce d(window);
    std::vector<bool> out;
    for (const std::int64_t t : times)
        out.push_back(d.accepts(t));
    return out;
}

} // namespace

TEST_CASE("the first edge passes, at any time")
{
    for (const std::int64_t t : {std::int64_t{0}, std::int64_t{5}, std::int64_t{1} << 62})
        CHECK(filter(1000, {t}) == std::vector{true});
}

TEST_CASE("an edge passes when the window is over to the nanosecond")
{
    CHECK(filter(1000, {0, 999}) == std::vector{true, false});
    CHECK(filter(1000, {0, 1000}) == std::vector{true, true});
}

TEST_CASE("a burst gives one edge, however long it bounces")
{
    CHECK(filter(1000, {0, 900, 1800, 2700, 3600, 4600}) ==
          std::vector{true, false, false, false, false, true});
}

TEST_CASE("without a window every edge passes")
{
    CHECK(filter(0, {7, 7, 7, 8}) == std::vector{true, true, true, true});
}

TEST_CASE("an edge passes where no other came before it within the window")
{
    std::mt19937_64 random(20240607);
    for (int round = 0; round < 2000; ++round) {
        const std::int64_t window = std::uniform_int_distribution<std::int64_t>(0, 5'000'000)(random);
        std::vector<std::int64_t> times{0};
        for (int i = 0; i < 50; ++i)
            times.push_back(times.back() + std::uniform_int_distribution<std::int64_t>(0, 8'000'000)(random));
        const std::vector<bool> passed = filter(window, times);
        for (std::size_t i = 0; i < times.size(); ++i)
            CHECK(passed[i] == (i == 0 || times[i] - times[i - 1] >= window));
    }
}

} // namespace debounce_test
