// SPDX-License-Identifier: MIT
#include "plan/leaving.hpp"

#include <algorithm>
#include <array>
#include <variant>
#include <vector>

#include "model/path_shape.hpp"
#include "model/trajectory_spans.hpp"
#include "plan/layout_impl.hpp"

namespace tactor::detail {
namespace {

double dot(point a, point b)
{
    return a.x_mm * b.x_mm + a.y_mm * b.y_mm;
}

/// What lies beyond an edge of the hull: more than `reach` in the direction `out`, which has length 1.
struct beyond {
    point out;
    double reach = 0.0;
};

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

/// The sides of the hull. Where all tactors are in one line that is a line: its two sides and its two ends.
std::vector<beyond> sides_of(const layout::impl& l)
{
    std::vector<beyond> sides;
    if (!l.hull.empty()) {
        for (const auto& [a, b] : l.rim)
            sides.push_back(beyond_edge(a, b));
        return sides;
    }
    const point first = farthest_from(l.points.front(), l.points);
    const point last = farthest_from(first, l.points);
    const point along = first == last ? point{1.0, 0.0} : 1.0 / distance_mm(first, last) * (last - first);
    const point across{along.y_mm, -along.x_mm};
    for (const point out : {along, across})
        for (const double sign : {1.0, -1.0})
            sides.push_back({sign * out, std::max(sign * dot(out, first), sign * dot(out, last))});
    return sides;
}

/// Corners of a convex figure round a curve.
std::array<point, 4> frame_of(const shape& form)
{
    if (const auto* b = std::get_if<cubic>(&form))
        return b->p;
    const auto& e = *std::get_if<elliptic>(&form);
    return {e.centre - e.u - e.v, e.centre - e.u + e.v, e.centre + e.u - e.v, e.centre + e.u + e.v};
}

/// Parameters, ascending, at which a curve turns round as seen from the sides that it may cross.
void turns_seen(const shape& form, const std::vector<beyond>& sides, std::vector<double>& turns_at)
{
    turns_at.clear();
    const std::array<point, 4> frame = frame_of(form);
    for (const beyond& s : sides) {
        const bool within =
            std::all_of(frame.begin(), frame.end(), [&](point p) { return dot(s.out, p) <= s.reach; });
        if (within)
            continue;
        const affine outwards_is_x{s.out.x_mm, -s.out.y_mm, s.out.y_mm, s.out.x_mm, 0.0, 0.0};
        const std::vector<double> t = turns(mapped(form, outwards_is_x), axis::x);
        turns_at.insert(turns_at.end(), t.begin(), t.end());
    }
    std::sort(turns_at.begin(), turns_at.end());
}

} // namespace

void check_inside(const job& j)
{
    const std::vector<beyond> sides = sides_of(j.faces.data());
    std::vector<double> turns_at;
    follower target(j);
    target.at(0.0);
    double latest_s = 0.0;
    const auto look = [&](double t_s) {
        latest_s = std::max(latest_s, t_s); // rounding may put the turn of a curve beside its end
        target.at(latest_s);
    };
    for_each_span(j.motion.motion, [&](const trajectory_span& span) {
        if (span.curve != nullptr) {
            turns_seen(*span.curve, sides, turns_at);
            for (const double t : turns_at)
                look(span.time_at(t));
        }
        look(span.to_s);
        return true;
    });
}

} // namespace tactor::detail
