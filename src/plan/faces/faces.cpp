// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "plan/faces/delaunay.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

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

/// Returns the border of a group of triangles; empty if that is not a single ring.
std::vector<unsigned> outline(const std::vector<triangle>& group)
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

/// Neighbours on one circle each need not mean that all are: a chain may drift off it.
bool on_one_circle(const std::vector<point>& points, const std::vector<unsigned>& ring)
{
    const std::size_t k = ring.size();
    const point a = points[ring[0]];
    const point b = points[ring[k / 3]];
    const point c = points[ring[2 * k / 3]];
    return std::all_of(ring.begin(), ring.end(), [&](unsigned v) {
        const point p = points[v];
        return p == a || p == b || p == c || cocircular({a, b, c, p});
    });
}

std::vector<unsigned> from_lowest(const triangle& t)
{
    std::vector<unsigned> ring(t.begin(), t.end());
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
    return ring;
}

} // namespace

bool cocircular(const std::array<point, 4>& p)
{
    std::array<double, 4> area{}; // of the triangle without point i, twice
    for (std::size_t i = 0; i < 4; ++i)
        area[i] = std::abs(turn(p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4]));
    const auto best = static_cast<std::size_t>(std::max_element(area.begin(), area.end()) - area.begin());
    if (!(area[best] > 0.0))
        return false;
    // Circle through the best conditioned three, seen from one of them.
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
    // The in-circle determinant changes with a move of point i as area[i] * radius, so this asks
    // whether moves of same_place_mm make it zero. Thin triangles count for what they weigh.
    return off * area[best] <= same_place_mm * (area[0] + area[1] + area[2] + area[3]);
}

std::vector<std::vector<unsigned>> join_cocircular(const std::vector<point>& points,
                                                   const std::vector<triangle>& triangles)
{
    groups g(triangles.size());
    const std::vector<bordering> edges = borders(triangles);
    for (std::size_t i = 1; i < edges.size(); ++i) {
        const bordering& e = edges[i - 1];
        const bordering& f = edges[i];
        if (e.low == f.low && e.high == f.high &&
            cocircular({points[e.low], points[e.high], points[apex(triangles[e.triangle], e)],
                        points[apex(triangles[f.triangle], f)]}))
            g.join(e.triangle, f.triangle);
    }

    std::map<unsigned, std::vector<triangle>> members;
    for (unsigned t = 0; t < triangles.size(); ++t)
        members[g.find(t)].push_back(triangles[t]);
    std::vector<std::vector<unsigned>> faces;
    for (const auto& [unused, group] : members) {
        std::vector<unsigned> ring = outline(group);
        if (ring.size() == group.size() + 2 && (group.size() == 1 || on_one_circle(points, ring)))
            faces.push_back(std::move(ring));
        else
            for (const triangle& t : group)
                faces.push_back(from_lowest(t));
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

} // namespace tactor::detail
