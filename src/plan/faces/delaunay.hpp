// SPDX-License-Identifier: MIT
/// \file
/// Delaunay triangles of a set of points, and the faces that they form.
#pragma once

#include <array>
#include <vector>

#include <tactor/path.hpp>

namespace tactor::detail {

using triangle = std::array<unsigned, 3>;

/// Returns Delaunay triangles of points that are not all in one line, each with positive turn(). Slivers on
/// the hull that are thinner than same_place_mm are left out: the points are in line there.
/// \throws error (bad_input) where two points are too near to each other for the extent of them all.
std::vector<triangle> delaunay(const std::vector<point>& points);

/// Joins neighbouring triangles whose points lie on one circle (each point within same_place_mm of
/// it). Faces are rings with positive turn that begin with their lowest point, in ascending order.
std::vector<std::vector<unsigned>> join_cocircular(const std::vector<point>& points,
                                                   const std::vector<triangle>& triangles);

} // namespace tactor::detail
