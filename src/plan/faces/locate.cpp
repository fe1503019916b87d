// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>

#include "plan/faces/layout_impl.hpp"
#include "plan/faces/plane.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::turn;

/// Searches for the wedge of a convex polygon that p is in, seen from its first corner.
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

/// Returns true if p is on the side of y from x as seen along a, b, and farther than `clear` from that line.
bool is_clear(point a, point b, point p, double clear_mm) noexcept
{
    const double area = turn(a, b, p);
    const double dx = b.x_mm - a.x_mm;
    const double dy = b.y_mm - a.y_mm;
    return area > 0.0 && area * area > clear_mm * clear_mm * (dx * dx + dy * dy);
}

} // namespace

std::optional<unsigned> layout::impl::clear_face(point p) const noexcept
{
    const unsigned face = latest.get();
    const std::vector<unsigned>& ring = faces[face];
    if (ring.size() < 3)
        return std::nullopt;
    point a = points[ring.back()];
    for (const unsigned v : ring) {
        const point b = points[v];
        if (!is_clear(a, b, p, clear_mm))
            return std::nullopt;
        a = b;
    }
    return face;
}

bool layout::impl::clear_of_diagonals(unsigned face, point p) const noexcept
{
    const std::vector<unsigned>& ring = faces[face];
    for (std::size_t i = 0; i + 2 < ring.size(); ++i)
        for (std::size_t k = i + 2; k < ring.size(); ++k) {
            const point a = points[ring[i]];
            const point b = points[ring[k]];
            if (!is_clear(a, b, p, clear_mm) && !is_clear(b, a, p, clear_mm))
                return false;
        }
    return true;
}

bool layout::impl::in_hull(point p) const
{
    if (clear_face(p))
        return true;
    if (!detail::finite(p))
        return false;
    return inside(hull, p) || distance_mm(p, nearest_in_hull(p)) <= same_place_mm;
}

point layout::impl::nearest_in_hull(point p) const
{
    if (!detail::finite(p))
        throw error(error_kind::bad_input, "point", "is not finite");
    if (inside(hull, p))
        return p;
    point best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : rim) {
        const point there = detail::nearest_on_segment(a, b, p);
        if (const double d = distance_mm(p, there); d < least) {
            least = d;
            best = there;
        }
    }
    return best;
}

unsigned layout::impl::nearest_tactor(point p) const
{
    unsigned best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (unsigned i = 0; i < points.size(); ++i)
        if (const double d = detail::length_mm(p, points[i]); d < least) {
            least = d;
            best = i;
        }
    return best;
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
    if (const auto face = clear_face(p)) {
        out.assign(1, *face);
        return;
    }
    // Slivers left out at the hull are thinner than the margin; the wider rounds are for what
    // rounding may do to arrays that are all slivers.
    for (double margin = same_place_mm; margin < 1e7; margin *= 10.0) {
        out.clear();
        for (unsigned f = 0; f < faces.size(); ++f)
            if (face_boxes[f].holds(p, margin) && face_holds(f, p, margin))
                out.push_back(f);
        if (!out.empty()) {
            latest.set(out.front());
            return;
        }
    }
}

} // namespace v0
} // namespace tactor
