// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <doctest/doctest.h>

#include "plot/paint/canvas.hpp"

namespace colours_test {

using namespace tactor::plot;

namespace {

double linear_light(std::uint8_t v) noexcept
{
    const double c = v / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// Returns relative luminance, 0 ... 1 (ITU-R BT.709 weights on linear light).
double luminance(colour c)
{
    return 0.2126 * linear_light(c.r) + 0.7152 * linear_light(c.g) + 0.0722 * linear_light(c.b);
}

} // namespace

TEST_CASE("the colours of time get steadily lighter, so that they are in order in grey too")
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

TEST_CASE("the lightest colour of time is visible on white")
{
    const double contrast = 1.05 / (luminance(ordered(1.0)) + 0.05);
    CHECK(contrast > 1.4);
    CHECK(luminance(ordered(0.0)) < 0.02);
}

TEST_CASE("a value out of range has the nearest colour")
{
    CHECK(ordered(-3.0) == ordered(0.0));
    CHECK(ordered(7.0) == ordered(1.0));
    CHECK(ordered(std::numeric_limits<double>::quiet_NaN()) == ordered(0.0));
    CHECK(ordered(std::numeric_limits<double>::infinity()) == ordered(0.0));
}

TEST_CASE("colours of strokes differ, are visible on white, and repeat")
{
    for (std::size_t i = 0; i < stroke_colours; ++i) {
        CHECK(luminance(stroke_colour(i)) < 0.6);
        for (std::size_t k = 0; k < i; ++k)
            CHECK(stroke_colour(i) != stroke_colour(k));
    }
    CHECK(stroke_colour(stroke_colours) == stroke_colour(0));
}

TEST_CASE("colours of lines differ in lightness")
{
    CHECK(std::abs(luminance(blue) - luminance(orange)) > 0.15);
    CHECK(std::abs(luminance(orange) - luminance(vermilion)) > 0.15);
    CHECK(std::abs(luminance(blue) - luminance(vermilion)) > 0.05);
}

} // namespace colours_test
