// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include <tactor/geometry.hpp>

namespace tactor::detail {

/// Corners of the convex hull, with positive turn; two for points in one line, none for a single one.
std::vector<point> convex_hull(std::vector<point> points);

} // namespace tactor::detail
