// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/path/shape.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

hull_side make_side(point a, point b)
{
    const double length = distance_mm(a, b);
    const point out{(b.y_mm - a.y_mm) / length, (a.x_mm - b.x_mm) / length};
    return {out, dot(out, a)};
}

point farthest_point(point p, const std::vector<point>& points)
{
    return *std::max_element(points.begin(), points.end(),
                             [p](point a, point b) { return distance_mm(p, a) < distance_mm(p, b); });
}

} // namespace

std::pair<point, point> find_ends(const std::vector<point>& points)
{
    const point first = farthest_point(points.front(), points);
    return {first, farthest_point(first, points)};
}

std::vector<hull_side> hull_sides(const layout::impl& l)
{
    std::vector<hull_side> sides;
    if (!l.hull.empty()) {
        for (const auto& [a, b] : l.rim)
            sides.push_back(make_side(a, b));
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

namespace tactor {
inline namespace v0 {
namespace {

using detail::box;
using detail::turn;

using rings = std::vector<std::vector<unsigned>>;

/// Returns indices by row, then by column. Rows that are at most same_place_mm apart count as one row.
std::vector<unsigned> rank_places(const std::vector<point>& places)
{
    std::vector<unsigned> order(places.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto by = [&places](double point::*first, double point::*then) {
        return [&places, first, then](unsigned a, unsigned b) {
            return std::tie(places[a].*first, places[a].*then) < std::tie(places[b].*first, places[b].*then);
        };
    };
    std::sort(order.begin(), order.end(), by(&point::y_mm, &point::x_mm));
    for (auto row = order.begin(); row != order.end();) {
        auto end = row + 1;
        while (end != order.end() && places[*end].y_mm - places[*(end - 1)].y_mm <= same_place_mm)
            ++end;
        std::sort(row, end, by(&point::x_mm, &point::y_mm));
        row = end;
    }
    return order;
}

/// Returns the ranks along the line on which all tactors lie. Empty if the tactors are not in one line.
std::vector<unsigned> find_line_order(const std::vector<point>& points)
{
    const std::pair<point, point> ends = detail::find_ends(points);
    const double length = distance_mm(ends.first, ends.second);
    for (const point p : points)
        if (std::abs(turn(ends.second, ends.first, p)) > same_place_mm * length)
            return {};
    std::vector<unsigned> order(points.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto away = [&](unsigned i) { return distance_mm(ends.second, points[i]); };
    std::sort(order.begin(), order.end(), [&](unsigned i, unsigned j) { return away(i) < away(j); });
    return order;
}

rings segments(const std::vector<unsigned>& order)
{
    if (order.size() == 1)
        return rings(1, order); // not {order}: gcc 14 reports a false overflow there
    rings s;
    for (std::size_t i = 1; i < order.size(); ++i)
        s.push_back({std::min(order[i - 1], order[i]), std::max(order[i - 1], order[i])});
    return s;
}

std::vector<box> make_boxes(const rings& faces, const std::vector<point>& points)
{
    std::vector<box> boxes;
    std::vector<point> corners;
    for (const auto& f : faces) {
        corners.clear();
        for (const unsigned v : f)
            corners.push_back(points[v]);
        boxes.push_back(detail::bounding_box(corners));
    }
    return boxes;
}

/// Returns the median of the tactors' distances to their nearest neighbours. Looks only at the edges of
/// faces: an edge always leads to the nearest neighbour.
double median_pitch(const rings& faces, const std::vector<point>& points)
{
    if (points.size() < 2)
        return 0.0;
    std::vector<double> d(points.size(), HUGE_VAL);
    for (const auto& f : faces)
        for (std::size_t i = 0; i < f.size(); ++i) {
            const unsigned a = f[i];
            const unsigned b = f[(i + 1) % f.size()];
            const double length = distance_mm(points[a], points[b]);
            d[a] = std::min(d[a], length);
            d[b] = std::min(d[b], length);
        }
    const auto middle = d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2);
    std::nth_element(d.begin(), middle, d.end());
    return d.size() % 2 == 1 ? *middle : std::midpoint(*middle, *std::max_element(d.begin(), middle));
}

/// Returns true if p is in a convex polygon. Bisects to find the wedge from the first corner that contains p.
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
    // Checks only edges of the hull: by rounding, a point may lie on neither side of a line between wedges.
    return turn(*(after - 1), *after, p) >= 0.0 && (after != last || turn(*last, hull.front(), p) >= 0.0);
}

/// Returns true if turn(a, b, p) > 0, and p is farther than `clear_mm` from the line through a and b.
bool is_clear(point a, point b, point p, double clear_mm) noexcept
{
    const double area = turn(a, b, p);
    const double dx = b.x_mm - a.x_mm;
    const double dy = b.y_mm - a.y_mm;
    return area > 0.0 && area * area > clear_mm * clear_mm * (dx * dx + dy * dy);
}

bool face_holds(const layout::impl& l, unsigned face, point p, double margin_mm)
{
    const std::vector<unsigned>& ring = l.faces[face];
    bool within = ring.size() >= 3;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const point a = l.points[ring[i]];
        const point b = l.points[ring[(i + 1) % ring.size()]];
        within = within && turn(a, b, p) >= 0.0;
        if (detail::segment_distance_mm(a, b, p) <= margin_mm)
            return true;
    }
    return within;
}

} // namespace

layout::impl::impl(const array& a)
{
    validate(a);
    for (const tactor_spec& t : a.tactors)
        places.push_back(t.position);
    index_of = rank_places(places);
    for (const unsigned i : index_of)
        points.push_back(places[i]);
    const std::vector<unsigned> line = find_line_order(points);
    if (line.empty()) {
        faces = detail::join_cocircular_triangles(points, detail::delaunay(points));
        for (const auto& f : faces) {
            by_index.emplace_back();
            for (const unsigned v : f)
                by_index.back().push_back(index_of[v]);
        }
        hull = detail::convex_hull(points);
        for (std::size_t i = 0; i < hull.size(); ++i)
            rim.emplace_back(hull[i], hull[(i + 1) % hull.size()]);
    } else {
        faces = segments(line);
        for (const auto& f : faces)
            rim.emplace_back(points[f.front()], points[f.back()]);
    }
    face_boxes = make_boxes(faces, points);
    pitch_mm = median_pitch(faces, points);
    const box all = detail::bounding_box(points);
    // Faces may overlap by the resolution of the sites from which they were made.
    clear_mm = 1e-4 + 1e-7 * distance_mm(all.low, all.high);
}

layout::layout(const array& a) : impl_(std::make_shared<const impl>(a))
{
}

const std::vector<point>& layout::places() const noexcept
{
    return impl_->places;
}

const std::vector<std::vector<unsigned>>& layout::faces() const noexcept
{
    return impl_->by_index;
}

bool layout::contains(point p) const
{
    if (impl_->find_clear_face(p))
        return true;
    if (!detail::finite(p))
        return false;
    return inside(impl_->hull, p) || distance_mm(p, nearest(p)) <= same_place_mm;
}

point layout::nearest(point p) const
{
    if (!detail::finite(p))
        throw error(error_kind::bad_input, "point", "is not finite");
    if (inside(impl_->hull, p))
        return p;
    point best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : impl_->rim) {
        const point on_edge = detail::nearest_segment_point(a, b, p);
        if (const double d = distance_mm(p, on_edge); d < least) {
            least = d;
            best = on_edge;
        }
    }
    return best;
}

double layout::pitch_mm() const noexcept
{
    return impl_->pitch_mm;
}

std::optional<unsigned> layout::impl::find_clear_face(point p) const noexcept
{
    const unsigned face = latest.load(std::memory_order_relaxed);
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

bool layout::impl::is_clear_of_diagonals(unsigned face, point p) const noexcept
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

void layout::impl::find_faces_at(point p, std::vector<unsigned>& out) const
{
    if (const auto face = find_clear_face(p)) {
        out.assign(1, *face);
        return;
    }
    // Slivers that were dropped at the hull are thinner than the first margin. Arrays that consist only of
    // slivers may need a wider margin, because of rounding.
    for (double margin = same_place_mm; margin < 1e7; margin *= 10.0) {
        out.clear();
        for (unsigned f = 0; f < faces.size(); ++f)
            if (face_boxes[f].holds(p, margin) && face_holds(*this, f, p, margin))
                out.push_back(f);
        if (!out.empty()) {
            latest.store(out.front(), std::memory_order_relaxed);
            return;
        }
    }
}

} // namespace v0
} // namespace tactor
