// SPDX-License-Identifier: MIT
/// \file
/// Contents of a layout. It identifies tactors by rank (by row, then by column), so that the order of tactors
/// in a file does not matter.
#pragma once

#include <atomic>
#include <optional>
#include <utility>
#include <vector>

#include <tactor/phantom.hpp>

#include "plan/faces/plane.hpp"

namespace tactor {
inline namespace v0 {

struct layout::impl {
    explicit impl(const array& a);

    std::vector<point> places;                   ///< places of the tactors, by index
    std::vector<std::vector<unsigned>> by_index; ///< faces for users, which consist of indices

    std::vector<point> points;      ///< places of the tactors, by rank
    std::vector<unsigned> index_of; ///< index of each rank
    /// Rings of ranks with positive turn, each beginning with the lowest rank. If all tactors are in one
    /// line, pairs of neighbours, or the single tactor.
    std::vector<std::vector<unsigned>> faces;
    std::vector<point> hull;                  ///< corners with positive turn; empty for a line
    std::vector<std::pair<point, point>> rim; ///< edges of the hull, or the line's segments
    double pitch_mm = 0.0;

    std::vector<detail::box> face_boxes; ///< bounding box of each face

    double clear_mm = 0.0; ///< distance from an edge that exceeds any rounding error
    /// Face of the previous point. The next point is mostly in the same face. Threads share this value; a
    /// wrong face only costs time.
    mutable std::atomic<unsigned> latest = 0;

    /// Replaces `out` by the faces (at least one) that contain p, with a tolerance of same_place_mm. p must
    /// be in the hull.
    void find_faces_at(point p, std::vector<unsigned>& out) const;
    /// Returns the face of the previous point if it contains p and p is farther than clear_mm from the edges.
    /// Returns nothing otherwise: then use find_faces_at().
    std::optional<unsigned> find_clear_face(point p) const noexcept;
    /// Returns true if p is farther than clear_mm from all diagonals of a face.
    bool is_clear_of_diagonals(unsigned face, point p) const noexcept;

    /// Returns the rank of the tactor nearest to p.
    unsigned nearest_tactor(point p) const;
};

} // namespace v0
} // namespace tactor

namespace tactor::detail {

/// Region beyond an edge of the hull: all points p with dot(out, p) > reach. `out` has length 1.
struct hull_side {
    point out;
    double reach = 0.0;
};

/// Returns the sides of the hull. If all tactors are in one line, returns the two sides and the two ends of
/// this line.
std::vector<hull_side> hull_sides(const layout::impl& l);

} // namespace tactor::detail
