// SPDX-License-Identifier: MIT
#include <algorithm>

#include "plan/layout_impl.hpp"
#include "plan/plane.hpp"

namespace tactor {
namespace {

using detail::turn;

/// Binary search for the wedge of a convex polygon that p is in, seen from its first corner.
bool inside(const std::vector<point>& hull, point p)
{
    if (hull.size() < 3)
        return false;
    const auto first = hull.begin() + 1;
    const auto last = hull.end() - 1;
    const auto after =
        std::partition_point(first, last, [&](point v) { return turn(hull.front(), v, p) >= 0.0; });
    if (after == first)
        return false;
    // Only edges of the hull count: with rounding a point may lie on neither side of a line between wedges.
    return turn(*(after - 1), *after, p) >= 0.0 && (after != last || turn(*last, hull.front(), p) >= 0.0);
}

} // namespace

bool layout::impl::in_hull(point p) const
{
    if (!detail::finite(p))
        return false;
    return inside(hull, p) || distance_mm(p, nearest_in_hull(p)) <= same_place_mm;
}

point layout::impl::nearest_in_hull(point p) const
{
    if (!detail::finite(p))
        throw error(errc::bad_input, "point", "is not finite");
    if (inside(hull, p))
        return p;
    const auto on_edge = [&](unsigned i) {
        return detail::nearest_on_segment(rim[i].first, rim[i].second, p);
    };
    return on_edge(rim_index.nearest(p, [&](unsigned i) { return distance_mm(p, on_edge(i)); }));
}

unsigned layout::impl::nearest_tactor(point p) const
{
    return tactor_index.nearest(p, [&](unsigned i) { return distance_mm(p, points[i]); });
}

bool layout::impl::face_holds(unsigned face, point p, double margin_mm) const
{
    const std::vector<unsigned>& ring = faces[face];
    bool within = ring.size() >= 3;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const point a = points[ring[i]];
        const point b = points[ring[(i + 1) % ring.size()]];
        within = within && turn(a, b, p) >= 0.0;
        if (detail::segment_distance_mm(a, b, p) <= margin_mm)
            return true;
    }
    return within;
}

void layout::impl::faces_at(point p, std::vector<unsigned>& out) const
{
    // Slivers left out at the hull are thinner than the margin; the wider rounds are for what
    // rounding may do to arrays that are all slivers.
    for (double margin = same_place_mm; margin < 1e7; margin *= 10.0) {
        face_index.near(p, margin, out);
        std::erase_if(out, [&](unsigned f) { return !face_holds(f, p, margin); });
        if (!out.empty())
            return;
    }
}

} // namespace tactor
