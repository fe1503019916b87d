// SPDX-License-Identifier: MIT
/// \file
/// Points on the skin.
#pragma once

#include <cmath>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// A place on the array in millimetres: x to the right, y down, as on a screen.
struct point {
    double x_mm = 0.0;
    double y_mm = 0.0;

    friend bool operator==(const point&, const point&) = default;
};

/// Distance between two points in millimetres.
inline double distance_mm(point a, point b) noexcept
{
    return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm);
}

/// Two places nearer to each other than this are the same place (a nanometre).
inline constexpr double same_place_mm = 1e-6;

} // namespace v0
} // namespace tactor
