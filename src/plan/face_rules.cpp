// SPDX-License-Identifier: MIT
#include "plan/face_rules.hpp"

#include <algorithm>
#include <limits>

#include "plan/plane.hpp"

namespace tactor::detail {
namespace {

struct found_segment {
    double length_mm;
    rank_pair ends;
};

/// Seen from any corner of a convex ring the others follow one another by direction, so the segments
/// from it that pass p are next to each other, and the first of them is found by halving.
void segments_through(const layout::impl& l, const std::vector<unsigned>& ring, point p,
                      std::vector<found_segment>& out)
{
    const std::size_t k = ring.size();
    for (std::size_t i = 0; i < k; ++i) {
        const point a = l.points[ring[i]];
        const auto other = [&](std::size_t step) { return ring[(i + step) % k]; };
        std::size_t low = 1;
        std::size_t high = k;
        while (low < high) {
            const std::size_t middle = low + (high - low) / 2;
            if (turn(a, p, l.points[other(middle)]) < 0.0)
                low = middle + 1;
            else
                high = middle;
        }
        const auto take = [&](std::size_t step) {
            const point b = l.points[other(step)];
            if (segment_distance_mm(a, b, p) > same_place_mm)
                return false;
            out.push_back({distance_mm(a, b), std::minmax(ring[i], other(step))});
            return true;
        };
        for (std::size_t step = low; step < k && take(step);)
            ++step;
        for (std::size_t step = low; step > 1 && take(step - 1);)
            --step;
    }
}

/// The closest tactor for which `allowed` holds, of ties the lowest; nothing if there is none.
template <class Allowed>
std::optional<unsigned> closest(const layout::impl& l, const std::vector<unsigned>& ring, point p,
                                const Allowed& allowed)
{
    double least = std::numeric_limits<double>::infinity();
    for (const unsigned v : ring)
        if (allowed(v))
            least = std::min(least, distance_mm(p, l.points[v]));
    std::optional<unsigned> best;
    for (const unsigned v : ring)
        if (allowed(v) && distance_mm(p, l.points[v]) <= least + same_place_mm && (!best || v < *best))
            best = v;
    return best;
}

} // namespace

std::optional<unsigned> tactor_at(const layout::impl& l, const std::vector<unsigned>& faces, point p)
{
    std::optional<unsigned> best;
    double least = same_place_mm;
    for (const unsigned f : faces)
        for (const unsigned v : l.faces[f]) {
            const double d = distance_mm(p, l.points[v]);
            if (d < least || (d == least && (!best || v < *best))) {
                least = d;
                best = v;
            }
        }
    return best;
}

std::optional<rank_pair> segment_at(const layout::impl& l, const std::vector<unsigned>& faces, point p)
{
    std::vector<found_segment> found;
    for (const unsigned f : faces)
        segments_through(l, l.faces[f], p, found);
    if (found.empty())
        return std::nullopt;
    const double shortest = std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
                                return a.length_mm < b.length_mm;
                            })->length_mm;
    rank_pair best{std::numeric_limits<unsigned>::max(), 0};
    for (const found_segment& s : found)
        if (s.length_mm <= shortest + same_place_mm)
            best = std::min(best, s.ends);
    return best;
}

std::optional<rank_triple> triangle_at(const layout::impl& l, unsigned face, point p)
{
    const std::vector<unsigned>& ring = l.faces[face];
    const auto first = closest(l, ring, p, [](unsigned) { return true; });
    const point a = l.points[*first];
    const auto side = [&](unsigned v) { return turn(a, p, l.points[v]); };

    // Two tactors on either side of the line from the closest one through p hold p with it if they
    // pass p on its far side. On each side the one that is nearest to that line there reaches farthest.
    std::optional<unsigned> left;
    std::optional<unsigned> right;
    for (const unsigned v : ring) {
        if (v == *first)
            continue;
        const point b = l.points[v];
        if (side(v) > 0.0 && (!left || turn(p, l.points[*left], b) < 0.0))
            left = v;
        if (side(v) < 0.0 && (!right || turn(p, l.points[*right], b) > 0.0))
            right = v;
    }
    if (!left || !right)
        return std::nullopt;
    const auto holds = [&](unsigned l_side, unsigned r_side) {
        return turn(p, l.points[r_side], l.points[l_side]) >= 0.0;
    };
    const auto second = closest(l, ring, p, [&](unsigned v) {
        return v != *first && ((side(v) > 0.0 && holds(v, *right)) || (side(v) < 0.0 && holds(*left, v)));
    });
    if (!second)
        return std::nullopt;
    const bool second_left = side(*second) > 0.0;
    const auto third = closest(l, ring, p, [&](unsigned v) {
        return second_left ? side(v) < 0.0 && holds(*second, v) : side(v) > 0.0 && holds(v, *second);
    });
    if (!third)
        return std::nullopt;
    return rank_triple{*first, *second, *third};
}

rank_pair nearest_edge(const layout::impl& l, unsigned face, point p)
{
    const std::vector<unsigned>& ring = l.faces[face];
    rank_pair best{ring[0], ring[1]};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const rank_pair ends = std::minmax(ring[i], ring[(i + 1) % ring.size()]);
        const double d = segment_distance_mm(l.points[ends.first], l.points[ends.second], p);
        if (d < least) {
            least = d;
            best = ends;
        }
    }
    return best;
}

rank_triple fan_triangle(const layout::impl& l, unsigned face, point p)
{
    const std::vector<unsigned>& ring = l.faces[face];
    rank_triple best{};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 2; i < ring.size(); ++i) {
        const point a = l.points[ring[0]];
        const point b = l.points[ring[i - 1]];
        const point c = l.points[ring[i]];
        const bool inside = turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
        // Halving would do but for faces so thin that rounding bends them.
        const double off = inside ? 0.0
                                  : std::min({segment_distance_mm(a, b, p), segment_distance_mm(b, c, p),
                                              segment_distance_mm(c, a, p)});
        if (off < least) {
            least = off;
            best = {ring[0], ring[i - 1], ring[i]};
        }
    }
    return best;
}

} // namespace tactor::detail
