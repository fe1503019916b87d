// SPDX-License-Identifier: MIT
#include "core/distance.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

namespace distance_test {

using namespace tactor;

TEST_CASE("lengths are those of std::hypot, to the last digit but one on every machine")
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 200'000; ++i) {
        const double x = std::ldexp(unit(random), static_cast<int>(random() % 60) - 30);
        const double y = i % 2 == 0 ? unit(random) : x * (1.0 + 1e-9 * unit(random));
        const double exact =
            static_cast<double>(std::hypot(static_cast<long double>(x), static_cast<long double>(y)));
        const double h = detail::portable_hypot(x, y);
        REQUIRE(h >= std::nextafter(exact, 0.0));
        REQUIRE(h <= std::nextafter(exact, HUGE_VAL));
        REQUIRE(h == detail::portable_hypot(-y, x));
    }
}

TEST_CASE("lengths of zero, of squares beyond the range, and of non-numbers")
{
    constexpr double huge = 1e300;
    constexpr double tiny = 1e-300;
    CHECK(detail::portable_hypot(0.0, 0.0) == 0.0);
    CHECK(detail::portable_hypot(0.0, -7.0) == 7.0);
    CHECK(detail::portable_hypot(3.0, 4.0) == 5.0);
    CHECK(detail::portable_hypot(3.0 * huge, 4.0 * huge) == std::hypot(3.0 * huge, 4.0 * huge));
    CHECK(detail::portable_hypot(3.0 * tiny, 4.0 * tiny) == std::hypot(3.0 * tiny, 4.0 * tiny));
    CHECK(std::isinf(detail::portable_hypot(HUGE_VAL, 1.0)));
    CHECK(std::isnan(detail::portable_hypot(std::numeric_limits<double>::quiet_NaN(), 1.0)));
    CHECK(detail::length_mm({1.0, 2.0}, {4.0, 6.0}) == 5.0);
}

} // namespace distance_test
