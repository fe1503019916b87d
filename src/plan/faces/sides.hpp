// SPDX-License-Identifier: MIT
/// \file
/// Sides of the array's hull, and places at which curves are farthest beyond them.
#pragma once

#include <array>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/shape.hpp"
#include "plan/faces/layout_impl.hpp"

namespace tactor::detail {

inline double dot(point a, point b) noexcept
{
    return a.x_mm * b.x_mm + a.y_mm * b.y_mm;
}

/// The region beyond an edge of the hull: more than `reach` in the direction `out`, which has length 1.
struct beyond {
    point out;
    double reach = 0.0;
};

/// Returns the sides of the hull. If all tactors are in one line, the hull is that line: its two sides and
/// two ends.
std::vector<beyond> hull_sides(const layout::impl& l);

/// Returns two tactors that are as far apart as any, in a line; elsewhere nearly so.
std::pair<point, point> find_ends(const std::vector<point>& points);

/// Returns the corners of a convex figure round a curve.
std::array<point, 4> control_frame(const shape& form);

/// Returns the parameters, ascending, at which a curve turns round as seen from a side.
std::vector<double> turns_towards(const shape& form, point out);

/// Returns the corners of the convex hull, with positive turn; two for points in one line, none for a single
/// one.
std::vector<point> convex_hull(std::vector<point> points);

} // namespace tactor::detail
