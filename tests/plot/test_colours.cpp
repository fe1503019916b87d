// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
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

namespace {

// Converts linear light, 0 ... 1, to that of colour-blind eyes: matrices of Machado et al. 2009 for full
// severity.
using matrix = std::array<std::array<double, 3>, 3>;
constexpr std::array<matrix, 4> sights{
    {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
     {{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}},
     {{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}},
     {{{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}}}};
constexpr matrix to_xyz{{{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};

std::array<double, 3> times(const matrix& m, const std::array<double, 3>& v)
{
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            out[i] += m[i][k] * v[k];
    return out;
}

double light(std::uint8_t v)
{
    const double c = v / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// Converts to CIELAB, D65.
std::array<double, 3> lab(colour c, const matrix& sight)
{
    std::array<double, 3> seen = times(sight, {light(c.r), light(c.g), light(c.b)});
    for (double& v : seen)
        v = std::clamp(v, 0.0, 1.0);
    const std::array<double, 3> white_point{0.9505, 1.0, 1.089};
    std::array<double, 3> f = times(to_xyz, seen);
    for (std::size_t i = 0; i < 3; ++i) {
        const double t = f[i] / white_point[i];
        f[i] = t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0;
    }
    return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

} // namespace

TEST_CASE("colours of strokes differ for eyes of each kind, and are visible on white")
{
    for (const matrix& sight : sights)
        for (std::size_t i = 0; i < stroke_colours; ++i) {
            const auto a = lab(stroke_colour(i), sight);
            CHECK(a[0] < 82.0);
            for (std::size_t k = 0; k < i; ++k) {
                const auto b = lab(stroke_colour(k), sight);
                CHECK(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) > 20.0);
            }
        }
    CHECK(stroke_colour(stroke_colours) == stroke_colour(0));
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
