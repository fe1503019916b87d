// SPDX-License-Identifier: MIT
#include "plan/faces/plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include <boost/polygon/point_data.hpp>
#include <boost/polygon/voronoi.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::detail {
namespace {

using site = boost::polygon::point_data<std::int32_t>;

// Converts points to 32-bit sites, for which Boost.Polygon is exact. The scale is a power of two, which keeps
// a grid of whole millimetres exactly rectangular; the resolution of a 1 m array is 5e-7 mm.
std::vector<site> quantise(const std::vector<point>& points)
{
    const box b = bounding_box(points);
    const point centre{std::midpoint(b.low.x_mm, b.high.x_mm), std::midpoint(b.low.y_mm, b.high.y_mm)};
    const double half = std::max(b.high.x_mm - b.low.x_mm, b.high.y_mm - b.low.y_mm) / 2.0;
    const double scale = std::exp2(29 - std::ilogb(half));
    std::vector<site> sites;
    sites.reserve(points.size());
    for (const point& p : points)
        sites.emplace_back(static_cast<std::int32_t>(std::lround((p.x_mm - centre.x_mm) * scale)),
                           static_cast<std::int32_t>(std::lround((p.y_mm - centre.y_mm) * scale)));
    return sites;
}

void check_distinct(const std::vector<point>& points, const std::vector<site>& sites)
{
    std::set<std::pair<std::int32_t, std::int32_t>> places;
    for (std::size_t i = 0; i < sites.size(); ++i)
        if (!places.emplace(sites[i].x(), sites[i].y()).second)
            throw error(error_kind::bad_input, "array",
                        fmt::format("two tactors at ({:.9g}, {:.9g}) mm are too close to each other for an "
                                    "array of this extent",
                                    points[i].x_mm, points[i].y_mm),
                        "check the unit: places are in millimetres");
}

std::vector<triangle> triangulate(const std::vector<site>& sites)
{
    boost::polygon::voronoi_diagram<double> diagram;
    boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
    std::vector<triangle> triangles;
    std::vector<unsigned> ring;
    for (const auto& vertex : diagram.vertices()) {
        ring.clear();
        const auto* edge = vertex.incident_edge();
        do {
            ring.push_back(static_cast<unsigned>(edge->cell()->source_index()));
            edge = edge->rot_next();
        } while (edge != vertex.incident_edge());
        // Sites on exactly one circle share one Voronoi vertex; join_cocircular_triangles() joins their
        // triangles again.
        for (std::size_t i = 2; i < ring.size(); ++i)
            triangles.push_back({ring[0], ring[i - 1], ring[i]});
    }
    return triangles;
}

void orient(const std::vector<point>& points, std::vector<triangle>& triangles)
{
    for (triangle& t : triangles)
        if (turn(points[t[0]], points[t[1]], points[t[2]]) < 0.0)
            std::swap(t[1], t[2]);
}

/// An edge of a triangulation and a triangle that it borders; `low` < `high`.
struct bordering {
    unsigned low;
    unsigned high;
    unsigned triangle;
};

/// Returns the edges of all triangles, sorted so that the two borders of one edge are neighbours.
std::vector<bordering> borders(const std::vector<triangle>& triangles)
{
    std::vector<bordering> edges;
    edges.reserve(3 * triangles.size());
    for (unsigned t = 0; t < triangles.size(); ++t)
        for (unsigned i = 0; i < 3; ++i) {
            const unsigned a = triangles[t][i];
            const unsigned b = triangles[t][(i + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), t});
        }
    std::sort(edges.begin(), edges.end(), [](const bordering& a, const bordering& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    return edges;
}

/// Filter that drops flat triangles on the hull, from the hull inwards.
class sliver_filter {
public:
    sliver_filter(const std::vector<point>& points, std::vector<triangle>& triangles)
        : points_(points),
          triangles_(triangles),
          edges_(borders(triangles)),
          dropped_(triangles.size(), false)
    {
    }

    void run()
    {
        std::vector<unsigned> work(triangles_.size());
        std::iota(work.rbegin(), work.rend(), 0U);
        while (!work.empty()) {
            const unsigned t = work.back();
            work.pop_back();
            if (flat(t) && drop(t))
                for (unsigned i = 0; i < 3; ++i)
                    for (const bordering& b : sides(ordered(triangles_[t][i], triangles_[t][(i + 1) % 3])))
                        work.push_back(b.triangle);
        }
        std::vector<triangle> rest;
        for (unsigned t = 0; t < triangles_.size(); ++t)
            if (!dropped_[t])
                rest.push_back(triangles_[t]);
        triangles_.swap(rest);
    }

private:
    using edge = std::pair<unsigned, unsigned>;

    static edge ordered(unsigned a, unsigned b) { return {std::min(a, b), std::max(a, b)}; }

    edge longest(const triangle& t) const
    {
        const auto length = [&](unsigned i) { return distance_mm(points_[t[i]], points_[t[(i + 1) % 3]]); };
        unsigned best = 0;
        for (unsigned i = 1; i < 3; ++i)
            if (length(i) > length(best))
                best = i;
        return ordered(t[best], t[(best + 1) % 3]);
    }

    bool flat(unsigned index) const
    {
        const triangle& t = triangles_[index];
        const auto [a, b] = longest(t);
        const double base = distance_mm(points_[a], points_[b]);
        return std::abs(turn(points_[t[0]], points_[t[1]], points_[t[2]])) < same_place_mm * base;
    }

    std::span<const bordering> sides(edge e) const
    {
        const auto [first, last] =
            std::equal_range(edges_.begin(), edges_.end(), bordering{e.first, e.second, 0},
                             [](const bordering& x, const bordering& y) {
                                 return std::tie(x.low, x.high) < std::tie(y.low, y.high);
                             });
        return {first, last};
    }

    bool is_on_hull(edge e) const
    {
        const auto s = sides(e);
        return std::count_if(s.begin(), s.end(), [&](const bordering& b) { return !dropped_[b.triangle]; }) ==
               1;
    }

    bool drop(unsigned index)
    {
        const triangle& t = triangles_[index];
        if (dropped_[index] || !is_on_hull(longest(t)))
            return false;
        // The triangle's other two edges must be edges of other triangles, too, or there would be a gap.
        int outer = 0;
        for (unsigned i = 0; i < 3; ++i)
            outer += is_on_hull(ordered(t[i], t[(i + 1) % 3])) ? 1 : 0;
        dropped_[index] = outer == 1;
        return dropped_[index];
    }

    const std::vector<point>& points_;
    std::vector<triangle>& triangles_;
    std::vector<bordering> edges_;
    std::vector<bool> dropped_;
};

/// Disjoint sets of triangles.
class groups {
public:
    explicit groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }

    unsigned find(unsigned i)
    {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }

    void join(unsigned a, unsigned b) { parent_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

private:
    std::vector<unsigned> parent_;
};

unsigned apex(const triangle& t, const bordering& edge)
{
    return *std::find_if(t.begin(), t.end(), [&](unsigned v) { return v != edge.low && v != edge.high; });
}

/// Returns the border of a group of triangles; empty if the border is not a single ring.
std::vector<unsigned> find_border(const std::vector<triangle>& group)
{
    std::map<std::pair<unsigned, unsigned>, bool> inner;
    for (const triangle& t : group)
        for (unsigned i = 0; i < 3; ++i)
            inner[{t[i], t[(i + 1) % 3]}] = false;
    std::map<unsigned, unsigned> next;
    std::size_t border = 0;
    for (const auto& [edge, unused] : inner)
        if (!inner.contains({edge.second, edge.first})) {
            next[edge.first] = edge.second;
            ++border;
        }
    std::vector<unsigned> ring;
    if (next.empty() || border != next.size())
        return ring;
    unsigned at = next.begin()->first;
    do {
        ring.push_back(at);
        const auto it = next.find(at);
        if (it == next.end() || ring.size() > border)
            return {};
        at = it->second;
    } while (at != ring.front());
    return ring.size() == border ? ring : std::vector<unsigned>{};
}

/// Returns true if four points lie on one circle, with a tolerance of same_place_mm for each point.
bool is_cocircular(const std::array<point, 4>& p)
{
    std::array<double, 4> area{}; // twice the area of the triangle without point i
    for (std::size_t i = 0; i < 4; ++i)
        area[i] = std::abs(turn(p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4]));
    const auto best = static_cast<std::size_t>(std::max_element(area.begin(), area.end()) - area.begin());
    if (!(area[best] > 0.0))
        return false;
    // Circle through the three points that determine it best. Coordinates are relative to o, one of them.
    const point o = p[(best + 1) % 4];
    const point u{p[(best + 2) % 4].x_mm - o.x_mm, p[(best + 2) % 4].y_mm - o.y_mm};
    const point v{p[(best + 3) % 4].x_mm - o.x_mm, p[(best + 3) % 4].y_mm - o.y_mm};
    const point w{p[best].x_mm - o.x_mm, p[best].y_mm - o.y_mm};
    const double uu = u.x_mm * u.x_mm + u.y_mm * u.y_mm;
    const double vv = v.x_mm * v.x_mm + v.y_mm * v.y_mm;
    const double ww = w.x_mm * w.x_mm + w.y_mm * w.y_mm;
    const double d = 2.0 * (u.x_mm * v.y_mm - u.y_mm * v.x_mm);
    const point centre{(v.y_mm * uu - u.y_mm * vv) / d, (u.x_mm * vv - v.x_mm * uu) / d};
    const double radius = std::hypot(centre.x_mm, centre.y_mm);
    const double power = ww - 2.0 * (w.x_mm * centre.x_mm + w.y_mm * centre.y_mm);
    const double off = std::abs(power) / (distance_mm(w, centre) + radius);
    // A move of point i changes the in-circle determinant in proportion to area[i] * radius, so this is
    // true if moves of same_place_mm make the determinant zero. Thin triangles have little weight.
    return off * area[best] <= same_place_mm * (area[0] + area[1] + area[2] + area[3]);
}

/// Returns true if all points of a ring are on one circle. It is not enough that each pair of neighbouring
/// triangles has a circle, because these circles may drift.
bool is_on_circle(const std::vector<point>& points, const std::vector<unsigned>& ring)
{
    const std::size_t k = ring.size();
    const point a = points[ring[0]];
    const point b = points[ring[k / 3]];
    const point c = points[ring[2 * k / 3]];
    return std::all_of(ring.begin(), ring.end(), [&](unsigned v) {
        const point p = points[v];
        return p == a || p == b || p == c || is_cocircular({a, b, c, p});
    });
}

std::vector<unsigned> rotate_to_lowest(const triangle& t)
{
    std::vector<unsigned> ring(t.begin(), t.end());
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
    return ring;
}

} // namespace

std::vector<triangle> delaunay(const std::vector<point>& points)
{
    const std::vector<site> sites = quantise(points);
    check_distinct(points, sites);
    std::vector<triangle> triangles = triangulate(sites);
    orient(points, triangles);
    sliver_filter(points, triangles).run();
    return triangles;
}

std::vector<std::vector<unsigned>> join_cocircular_triangles(const std::vector<point>& points,
                                                             const std::vector<triangle>& triangles)
{
    groups g(triangles.size());
    const std::vector<bordering> edges = borders(triangles);
    for (std::size_t i = 1; i < edges.size(); ++i) {
        const bordering& e = edges[i - 1];
        const bordering& f = edges[i];
        if (e.low == f.low && e.high == f.high &&
            is_cocircular({points[e.low], points[e.high], points[apex(triangles[e.triangle], e)],
                           points[apex(triangles[f.triangle], f)]}))
            g.join(e.triangle, f.triangle);
    }

    std::map<unsigned, std::vector<triangle>> members;
    for (unsigned t = 0; t < triangles.size(); ++t)
        members[g.find(t)].push_back(triangles[t]);
    std::vector<std::vector<unsigned>> faces;
    for (const auto& [unused, group] : members) {
        std::vector<unsigned> ring = find_border(group);
        if (ring.size() == group.size() + 2 && (group.size() == 1 || is_on_circle(points, ring)))
            faces.push_back(std::move(ring));
        else
            for (const triangle& t : group)
                faces.push_back(rotate_to_lowest(t));
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

} // namespace tactor::detail
