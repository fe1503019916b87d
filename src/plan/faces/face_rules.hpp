// SPDX-License-Identifier: MIT
/// \file
/// Tactors to which a point belongs (rendering model, section 4). Tactors go by rank.
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

/// Returns the tactor that p is on, of the given faces.
std::optional<unsigned> tactor_at(const layout::impl& l, const std::vector<unsigned>& faces, point p);

/// Applies rule 2: the segment between two tactors of one face that p is on; of several the shortest, then
/// the one of lowest rank. p is on no tactor. O(k log k) in a face's tactors.
std::optional<rank_pair> segment_at(const layout::impl& l, const std::vector<unsigned>& faces, point p);

/// Applies rule 2 to three tactors, wherever they lie.
std::optional<rank_pair> segment_at(const layout::impl& l, const rank_triple& three, point p);

/// Applies rule 3: of all triangles of the face's tactors that hold p, the first by the distances of its
/// tactors: the closest, then the second, then the third. p is on no segment of the face. O(k).
std::optional<near_triple> triangle_at(const layout::impl& l, unsigned face, point p);

/// Returns the three of these tactors that are closest to p, in this order, of ties the lowest. There are
/// three or more. O(k).
near_triple closest_three(const layout::impl& l, const std::vector<unsigned>& ranks, point p);

/// Returns the segment between neighbours on the face's ring that is nearest to p.
rank_pair nearest_edge(const layout::impl& l, unsigned face, point p);

/// Returns the triangle that holds p, or else is nearest, of the fan from the face's lowest tactor; for faces
/// of three and more tactors.
rank_triple fan_triangle(const layout::impl& l, unsigned face, point p);

} // namespace tactor::detail
