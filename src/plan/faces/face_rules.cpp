// SPDX-License-Identifier: MIT
#include "plan/faces/face_rules.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include <boost/container/small_vector.hpp>

#include "plan/faces/plane.hpp"

namespace tactor::detail {
namespace {

struct found_segment {
    double length_mm;
    rank_pair ends;
};

/// Adds the segment from u to v if p is on it. Otherwise returns false.
bool try_add_segment(const layout::impl& l, unsigned u, unsigned v, point p, std::vector<found_segment>& out)
{
    const point a = l.points[u];
    const point b = l.points[v];
    if (segment_distance_mm(a, b, p) > same_place_mm)
        return false;
    out.push_back({distance_mm(a, b), std::minmax(u, v)});
    return true;
}

/// Returns the shortest segment. Of segments with equal lengths, returns the segment with the lowest ranks.
std::optional<rank_pair> shortest(const std::vector<found_segment>& found)
{
    if (found.empty())
        return std::nullopt;
    const double least = std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
                             return a.length_mm < b.length_mm;
                         })->length_mm;
    rank_pair best{std::numeric_limits<unsigned>::max(), 0};
    for (const found_segment& s : found)
        if (s.length_mm <= least + same_place_mm)
            best = std::min(best, s.ends);
    return best;
}

/// Finds the segments through p between corners of a convex ring. From one corner, the other corners are in
/// order of direction, so the segments from this corner through p are neighbours. Bisection finds the first
/// of these segments.
void find_segments_through(const layout::impl& l, const std::vector<unsigned>& ring, point p,
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
        const auto take = [&](std::size_t step) { return try_add_segment(l, ring[i], other(step), p, out); };
        for (std::size_t step = low; step < k && take(step);)
            ++step;
        for (std::size_t step = low; step > 1 && take(step - 1);)
            --step;
    }
}

/// A tactor, and its position relative to a point p.
struct seen_tactor {
    unsigned rank;
    double far_mm;
    double side = 0.0; ///< > 0 if left of the line from the closest tactor through p
};

/// Tactors and their positions relative to a point; mostly the few tactors of a face.
using seen_tactors = boost::container::small_vector<seen_tactor, 8>;

seen_tactors measure_tactors(const layout::impl& l, const std::vector<unsigned>& ranks, point p)
{
    seen_tactors all;
    for (const unsigned rank : ranks)
        all.push_back({rank, length_mm(p, l.points[rank])});
    return all;
}

/// Returns the closest tactor for which `allowed` returns true, or null if there is none. Of tactors at equal
/// distances, returns the tactor with the lowest rank.
template <class Allowed>
const seen_tactor* closest(const seen_tactors& all, const Allowed& allowed)
{
    double least = std::numeric_limits<double>::infinity();
    for (const seen_tactor& v : all)
        if (allowed(v))
            least = std::min(least, v.far_mm);
    const seen_tactor* best = nullptr;
    for (const seen_tactor& v : all)
        if (allowed(v) && v.far_mm <= least + same_place_mm && (best == nullptr || v.rank < best->rank))
            best = &v;
    return best;
}

} // namespace

std::optional<unsigned> tactor_at(const layout::impl& l, const std::vector<unsigned>& faces, point p)
{
    std::optional<unsigned> best;
    double least = same_place_mm;
    for (const unsigned f : faces)
        for (const unsigned v : l.faces[f]) {
            const double d = length_mm(p, l.points[v]);
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
        find_segments_through(l, l.faces[f], p, found);
    return shortest(found);
}

std::optional<rank_pair> segment_at(const layout::impl& l, const rank_triple& three, point p)
{
    std::vector<found_segment> found;
    try_add_segment(l, three[0], three[1], p, found);
    try_add_segment(l, three[0], three[2], p, found);
    try_add_segment(l, three[1], three[2], p, found);
    return shortest(found);
}

std::optional<near_triple> triangle_at(const layout::impl& l, unsigned face, point p)
{
    seen_tactors ring = measure_tactors(l, l.faces[face], p);
    const seen_tactor* first = closest(ring, [](const seen_tactor&) { return true; });
    const auto place = [&](const seen_tactor* v) { return l.points[v->rank]; };
    for (seen_tactor& v : ring)
        v.side = turn(place(first), p, place(&v));

    // Consider the line from the closest tactor through p. The closest tactor, a tactor on the left of the
    // line and a tactor on the right form a triangle. It contains p if the segment from left to right
    // crosses the line beyond p. On each side, the tactor whose direction from p is nearest to the
    // direction of the line is the best choice.
    const seen_tactor* left = nullptr;
    const seen_tactor* right = nullptr;
    for (const seen_tactor& v : ring) {
        if (&v == first)
            continue;
        if (v.side > 0.0 && (left == nullptr || turn(p, place(left), place(&v)) < 0.0))
            left = &v;
        if (v.side < 0.0 && (right == nullptr || turn(p, place(right), place(&v)) > 0.0))
            right = &v;
    }
    if (left == nullptr || right == nullptr)
        return std::nullopt;
    const auto holds = [&](const seen_tactor* l_side, const seen_tactor* r_side) {
        return turn(p, place(r_side), place(l_side)) >= 0.0;
    };
    const seen_tactor* second = closest(ring, [&](const seen_tactor& v) {
        return &v != first && ((v.side > 0.0 && holds(&v, right)) || (v.side < 0.0 && holds(left, &v)));
    });
    if (second == nullptr)
        return std::nullopt;
    const seen_tactor* third = closest(ring, [&](const seen_tactor& v) {
        return second->side > 0.0 ? v.side < 0.0 && holds(second, &v) : v.side > 0.0 && holds(&v, second);
    });
    if (third == nullptr)
        return std::nullopt;
    return near_triple{{first->rank, second->rank, third->rank},
                       {first->far_mm, second->far_mm, third->far_mm}};
}

near_triple closest_three(const layout::impl& l, const std::vector<unsigned>& ranks, point p)
{
    const seen_tactors all = measure_tactors(l, ranks, p);
    const seen_tactor* first = closest(all, [](const seen_tactor&) { return true; });
    const seen_tactor* second = closest(all, [&](const seen_tactor& v) { return &v != first; });
    const seen_tactor* third =
        closest(all, [&](const seen_tactor& v) { return &v != first && &v != second; });
    return {{first->rank, second->rank, third->rank}, {first->far_mm, second->far_mm, third->far_mm}};
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
        // No bisection: in very thin faces rounding breaks the order of directions.
        const double off = triangle_distance_mm(a, b, c, p);
        if (off < least) {
            least = off;
            best = {ring[0], ring[i - 1], ring[i]};
        }
    }
    return best;
}

} // namespace tactor::detail
