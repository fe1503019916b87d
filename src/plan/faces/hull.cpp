// SPDX-License-Identifier: MIT
#include "plan/faces/hull.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "plan/faces/plane.hpp"

namespace tactor::detail {

// Andrew's monotone chain.
std::vector<point> convex_hull(std::vector<point> points)
{
    std::sort(points.begin(), points.end(),
              [](point a, point b) { return std::tie(a.x_mm, a.y_mm) < std::tie(b.x_mm, b.y_mm); });
    std::vector<point> hull;
    const auto half = [&hull](auto first, auto last) {
        const std::size_t start = hull.size();
        for (auto it = first; it != last; ++it) {
            while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), *it) <= 0.0)
                hull.pop_back();
            hull.push_back(*it);
        }
        hull.pop_back();
    };
    half(points.begin(), points.end());
    half(points.rbegin(), points.rend());
    return hull;
}

} // namespace tactor::detail
