// SPDX-License-Identifier: MIT
/// \file
/// Rules that choose the tactors for a point (rendering model, section 4). They identify tactors by rank.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "plan/faces/layout_impl.hpp"

namespace tactor::detail {

using rank_pair = std::pair<unsigned, unsigned>;
using rank_triple = std::array<unsigned, 3>;

/// Three tactors and their distances from a point, mm.
struct near_triple {
    rank_triple tactors;
    std::array<double, 3> distances;
};

/// Returns the tactor of the given faces at p, if any.
std::optional<unsigned> tactor_at(const layout::impl& l, const std::vector<unsigned>& faces, point p);

/// Applies rule 2: returns the segment between two tactors of one face that contains p. Of several segments,
/// returns the shortest, and of equal lengths the lowest ranks. p must not be on a tactor. O(k log k) for a
/// face with k tactors.
std::optional<rank_pair> segment_at(const layout::impl& l, const std::vector<unsigned>& faces, point p);

/// Applies rule 2 to three tactors, which need not have a face in common.
std::optional<rank_pair> segment_at(const layout::impl& l, const rank_triple& three, point p);

/// Applies rule 3: of the triangles of the face's tactors that contain p, returns the triangle whose closest
/// tactor is nearest to p, then the second, then the third. p must not be on a segment of the face. O(k).
std::optional<near_triple> triangle_at(const layout::impl& l, unsigned face, point p);

/// Returns the three tactors of `ranks` that are closest to p, the closest first. Of tactors at equal
/// distances, the lowest rank comes first. `ranks` must have at least three tactors. O(k).
near_triple closest_three(const layout::impl& l, const std::vector<unsigned>& ranks, point p);

/// Returns the edge of the face that is nearest to p.
rank_pair nearest_edge(const layout::impl& l, unsigned face, point p);

/// Divides the face into a fan of triangles that share the tactor with the lowest rank. Returns the triangle
/// that contains p, or else the nearest triangle. The face must have at least three tactors.
rank_triple fan_triangle(const layout::impl& l, unsigned face, point p);

} // namespace tactor::detail
