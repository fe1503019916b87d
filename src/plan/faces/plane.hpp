// SPDX-License-Identifier: MIT
/// \file
/// Plane geometry on points in millimetres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <tactor/path.hpp>

#include "core/path/shape.hpp"

namespace tactor::detail {

/// Returns twice the signed area of the triangle a, b, c. Positive if the path a, b, c turns from x towards
/// y.
inline double turn(point a, point b, point c) noexcept
{
    return (b.x_mm - a.x_mm) * (c.y_mm - a.y_mm) - (b.y_mm - a.y_mm) * (c.x_mm - a.x_mm);
}

/// Returns the point of the segment a, b that is nearest to p.
inline point nearest_segment_point(point a, point b, point p) noexcept
{
    const double dx = b.x_mm - a.x_mm;
    const double dy = b.y_mm - a.y_mm;
    const double square = dx * dx + dy * dy;
    if (!(square > 0.0))
        return a;
    const double u = ((p.x_mm - a.x_mm) * dx + (p.y_mm - a.y_mm) * dy) / square;
    if (u <= 0.0)
        return a;
    if (u >= 1.0)
        return b;
    return {a.x_mm + u * dx, a.y_mm + u * dy};
}

inline double segment_distance_mm(point a, point b, point p) noexcept
{
    return length_mm(p, nearest_segment_point(a, b, p));
}

/// Returns the distance of p from the triangle a, b, c, or 0 if p is inside. turn(a, b, c) must be >= 0.
inline double triangle_distance_mm(point a, point b, point c, point p) noexcept
{
    if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0)
        return 0.0;
    return std::min(
        {segment_distance_mm(a, b, p), segment_distance_mm(b, c, p), segment_distance_mm(c, a, p)});
}

inline bool finite(point p) noexcept
{
    return std::isfinite(p.x_mm) && std::isfinite(p.y_mm);
}

/// Returns two points that are farthest apart if all points are in one line, or else nearly farthest apart.
std::pair<point, point> find_ends(const std::vector<point>& points);

/// Returns the corners of the convex hull, with positive turn. Returns two points if all points are in one
/// line, and none for a single point.
std::vector<point> convex_hull(std::vector<point> points);

using triangle = std::array<unsigned, 3>;

/// Returns Delaunay triangles of points that are not all in one line, each with positive turn(). Leaves out
/// slivers on the hull that are thinner than same_place_mm, because their points count as in one line.
/// \throws error (bad_input) if two points are too near to each other for the extent of all points.
std::vector<triangle> delaunay(const std::vector<point>& points);

/// Joins neighbouring triangles whose points lie on one circle, with a tolerance of same_place_mm. Returns
/// the faces in ascending order. A face is a ring with positive turn that begins with the lowest index.
std::vector<std::vector<unsigned>> join_cocircular_triangles(const std::vector<point>& points,
                                                             const std::vector<triangle>& triangles);

} // namespace tactor::detail
