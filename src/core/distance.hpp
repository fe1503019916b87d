// SPDX-License-Identifier: MIT
/// \file
/// Inline lengths: a call of std::hypot takes as long as the rest of a phantom.
#pragma once

#include <cmath>

#include <tactor/path.hpp>

namespace tactor::detail {

/// Returns std::hypot(x, y) on every machine, bit for bit as the C library has computed it since glibc 2.35
/// without fused multiplications (Borges 2019, algorithm "fused" without the fusing).
[[gnu::always_inline]] inline double portable_hypot(double x, double y) noexcept
{
    const double u = std::abs(x);
    const double v = std::abs(y);
    const double a = u < v ? v : u;
    const double b = u < v ? u : v;
    if (!(b >= 0x1p-459 && a <= 0x1p511)) // numbers whose squares would lose digits, and infinite ones
        return std::hypot(x, y);
    if (b <= a * 0x1p-54)
        return a + b;
    const double h = std::sqrt(a * a + b * b);
    const bool near = h <= 2.0 * b;
    const double d = h - (near ? b : a);
    const double first = near ? a * (2.0 * d - a) : 2.0 * d * (a - 2.0 * b);
    const double second = near ? (d - 2.0 * (a - b)) * d : (4.0 * d - b) * b + d * d;
    return h - (first + second) / (2.0 * h);
}

/// Returns tactor::distance_mm().
[[gnu::always_inline]] inline double length_mm(point a, point b) noexcept
{
    return portable_hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm);
}

} // namespace tactor::detail
