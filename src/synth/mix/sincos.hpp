// SPDX-License-Identifier: MIT
/// \file
/// Sine and cosine of an angle in cycles, with equal bits on every machine. The C library's depend on its
/// version and the processor.
#pragma once

#include <bit>
#include <cstdint>

namespace tactor::synth {

struct sine_cosine {
    double sin = 0.0;
    double cos = 1.0;
};

/// 1.5 * 2^52: adding it leaves no space for a fraction.
inline constexpr double rounds = 6755399441055744.0;

/// Rounds to the nearest integer, half to even, in plain arithmetic; |x| < 2^51.
inline double nearest(double x) noexcept
{
    return (x + rounds) - rounds;
}

/// Returns sin and cos of 2 pi x to about 1e-16, for |x| < 5e14: 40 years of the highest carrier. Taylor
/// series on an eighth of a circle on either side of the nearest quarter; the next terms are under 1e-18. No
/// branches, so loops over it become vector code.
inline sine_cosine sincos_turns(double x) noexcept
{
    const double shifted = 4.0 * x + rounds;
    const double quarter = shifted - rounds;
    const double t = 6.283185307179586477 * (x - 0.25 * quarter);
    const double u = t * t;
    double s = 1.0 / 355687428096000.0;
    s = s * u - 1.0 / 1307674368000.0;
    s = s * u + 1.0 / 6227020800.0;
    s = s * u - 1.0 / 39916800.0;
    s = s * u + 1.0 / 362880.0;
    s = s * u - 1.0 / 5040.0;
    s = s * u + 1.0 / 120.0;
    s = s * u - 1.0 / 6.0;
    s = t + t * (u * s);
    double c = 1.0 / 20922789888000.0;
    c = c * u - 1.0 / 87178291200.0;
    c = c * u + 1.0 / 479001600.0;
    c = c * u - 1.0 / 3628800.0;
    c = c * u + 1.0 / 40320.0;
    c = c * u - 1.0 / 720.0;
    c = c * u + 1.0 / 24.0;
    c = 1.0 + u * (u * c - 0.5);
    // The low bits of the shifted number are those of the count of quarters.
    const auto quarters = std::bit_cast<std::uint64_t>(shifted);
    const bool odd = (quarters & 1) != 0;
    const auto negative = [](double v, std::uint64_t bit) {
        return std::bit_cast<double>(std::bit_cast<std::uint64_t>(v) ^ (bit << 63));
    };
    return {negative(odd ? c : s, quarters >> 1 & 1), negative(odd ? s : c, (quarters + 1) >> 1 & 1)};
}

} // namespace tactor::synth
