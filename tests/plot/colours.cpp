// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "plot/colours.hpp"

namespace colours_test {

using namespace tactor::plot;

TEST_CASE("the colours of time get lighter all the way, so that they are in order in grey too")
{
    double before = luminance(ordered(0.0));
    for (int i = 1; i <= 1000; ++i) {
        const double now = luminance(ordered(i / 1000.0));
        CHECK(now >= before - 0.002); // steps of 8-bit colours
        before = now;
    }
    // Evenly: a tenth of the map is never lost.
    for (int i = 0; i < 10; ++i)
        CHECK(std::sqrt(luminance(ordered((i + 1) / 10.0))) - std::sqrt(luminance(ordered(i / 10.0))) > 0.04);
}

TEST_CASE("the lightest colour of time is still seen on white")
{
    const double contrast = 1.05 / (luminance(ordered(1.0)) + 0.05);
    CHECK(contrast > 1.4);
    CHECK(luminance(ordered(0.0)) < 0.02);
}

TEST_CASE("what is out of range is the nearest colour")
{
    CHECK(ordered(-3.0) == ordered(0.0));
    CHECK(ordered(7.0) == ordered(1.0));
    CHECK(ordered(std::numeric_limits<double>::quiet_NaN()) == ordered(0.0));
    CHECK(ordered(std::numeric_limits<double>::infinity()) == ordered(0.0));
}

TEST_CASE("luminance is 0 for black and 1 for white")
{
    CHECK(luminance(black) == doctest::Approx(0.0));
    CHECK(luminance(white) == doctest::Approx(1.0));
}

TEST_CASE("colours of lines differ in lightness")
{
    CHECK(std::abs(luminance(blue) - luminance(orange)) > 0.15);
    CHECK(std::abs(luminance(orange) - luminance(vermilion)) > 0.15);
    CHECK(std::abs(luminance(blue) - luminance(vermilion)) > 0.05);
}

} // namespace colours_test
