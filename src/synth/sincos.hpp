// SPDX-License-Identifier: MIT
/// \file
/// Sine and cosine of an angle in cycles, the same bits on every machine: the C library's depend on
/// its version and on the processor that it finds.
#pragma once

#include <cmath>
#include <cstdint>

namespace tactor::synth {

struct sine_cosine {
    double sin = 0.0;
    double cos = 1.0;
};

/// Rounds to the nearest integer, half to even, in plain arithmetic; |x| < 2^51.
inline double nearest(double x) noexcept
{
    constexpr double magic = 6755399441055744.0; // 1.5 * 2^52: no room for a fraction
    return (x + magic) - magic;
}

/// sin and cos of 2 pi x to about 1e-16. Taylor series on an eighth of a circle either side of the
/// nearest quarter: the next terms are under 1e-18. Anything finite may come in.
inline sine_cosine sincos_cycles(double x) noexcept
{
    if (!(std::abs(x) < 1e15)) {
        x = std::isfinite(x) ? std::fmod(x, 1.0) : 0.0;
    }
    const double quarter = nearest(4.0 * x);
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
    switch (static_cast<std::int64_t>(quarter) & 3) {
    case 0:
        return {s, c};
    case 1:
        return {c, -s};
    case 2:
        return {-s, -c};
    default:
        return {-c, s};
    }
}

} // namespace tactor::synth
