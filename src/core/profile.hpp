// SPDX-License-Identifier: MIT
// Values over the part of a path.
#pragma once

#include <algorithm>
#include <vector>

namespace tactor::detail {

/// Returns points by part of the path, in the order from its other end.
template <class Point>
std::vector<Point> from_the_end(std::vector<Point> points)
{
    std::reverse(points.begin(), points.end());
    for (Point& p : points)
        p.part = 1.0 - p.part;
    return points;
}

} // namespace tactor::detail
