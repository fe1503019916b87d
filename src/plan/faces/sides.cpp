// SPDX-License-Identifier: MIT
#include "plan/faces/sides.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <variant>

#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

beyond beyond_edge(point a, point b)
{
    const double length = distance_mm(a, b);
    const point out{(b.y_mm - a.y_mm) / length, (a.x_mm - b.x_mm) / length};
    return {out, dot(out, a)};
}

point farthest_from(point p, const std::vector<point>& points)
{
    return *std::max_element(points.begin(), points.end(),
                             [p](point a, point b) { return distance_mm(p, a) < distance_mm(p, b); });
}

} // namespace

std::pair<point, point> find_ends(const std::vector<point>& points)
{
    const point first = farthest_from(points.front(), points);
    return {first, farthest_from(first, points)};
}

std::vector<beyond> hull_sides(const layout::impl& l)
{
    std::vector<beyond> sides;
    if (!l.hull.empty()) {
        for (const auto& [a, b] : l.rim)
            sides.push_back(beyond_edge(a, b));
        return sides;
    }
    const auto [first, last] = find_ends(l.points);
    const point along = first == last ? point{1.0, 0.0} : 1.0 / distance_mm(first, last) * (last - first);
    const point across{along.y_mm, -along.x_mm};
    for (const point out : {along, across})
        for (const double sign : {1.0, -1.0})
            sides.push_back({sign * out, std::max(sign * dot(out, first), sign * dot(out, last))});
    return sides;
}

std::array<point, 4> control_frame(const shape& form)
{
    if (const auto* b = std::get_if<cubic>(&form))
        return b->p;
    const auto& e = *std::get_if<elliptic>(&form);
    return {e.centre - e.u - e.v, e.centre - e.u + e.v, e.centre + e.u - e.v, e.centre + e.u + e.v};
}

std::vector<double> turns_towards(const shape& form, point out)
{
    const affine outwards_is_x{out.x_mm, -out.y_mm, out.y_mm, out.x_mm, 0.0, 0.0};
    return turns(mapped(form, outwards_is_x), axis::x);
}

// Uses Andrew's monotone chain.
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
