// SPDX-License-Identifier: MIT
/// \file
/// Tactors to which a point belongs (rendering model, section 4), by rank.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "plan/faces/layout_impl.hpp"

namespace tactor::detail {

using rank_pair = std::pair<unsigned, unsigned>;
using rank_triple = std::array<unsigned, 3>;

/// Three tactors, and how far from a point they are, mm.
struct near_triple {
    rank_triple tactors;
    std::array<double, 3> distances;
};

/// Returns the tactor of the given faces at p, if any.
std::optional<unsigned> tactor_at(const layout::impl& l, const std::vector<unsigned>& faces, point p);

/// Applies rule 2: returns the segment between two tactors of one face that p is on; of several the shortest,
/// then that of lowest rank. p must not be on a tactor. O(k log k) in a face's tactors.
std::optional<rank_pair> segment_at(const layout::impl& l, const std::vector<unsigned>& faces, point p);

/// Applies rule 2 to three tactors, wherever they lie.
std::optional<rank_pair> segment_at(const layout::impl& l, const rank_triple& three, point p);

/// Applies rule 3: returns the triangle of the face's tactors that holds p and whose closest, then second,
/// then third tactor is nearest to p. p must not be on a segment of the face. O(k).
std::optional<near_triple> triangle_at(const layout::impl& l, unsigned face, point p);

/// Returns the three of these (at least three) tactors that are closest to p, in this order; of equal
/// distances the lowest rank. O(k).
near_triple closest_three(const layout::impl& l, const std::vector<unsigned>& ranks, point p);

/// Returns the segment between neighbours on the face's ring that is nearest to p.
rank_pair nearest_edge(const layout::impl& l, unsigned face, point p);

/// Returns the triangle that holds p, or else the nearest one, from the fan of the face's lowest tactor. The
/// face has at least three tactors.
rank_triple fan_triangle(const layout::impl& l, unsigned face, point p);

} // namespace tactor::detail
