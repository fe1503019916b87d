// SPDX-License-Identifier: MIT
/// \file
/// Contents of a layout. It identifies tactors by rank (by row, then by column), so that their order in a
/// file does not matter.
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

    std::vector<point> places;                   ///< by index
    std::vector<std::vector<unsigned>> by_index; ///< public faces, by index

    std::vector<point> points;      ///< by rank
    std::vector<unsigned> index_of; ///< rank to index
    /// Rings of ranks with positive turn, each from its lowest rank. If all tactors are in one line: pairs of
    /// neighbours, or the single tactor.
    std::vector<std::vector<unsigned>> faces;
    std::vector<point> hull;                  ///< corners with positive turn; none for a line
    std::vector<std::pair<point, point>> rim; ///< edges of the hull, or the line's segments
    double pitch_mm = 0.0;

    std::vector<detail::box> face_boxes; ///< round each face

    double clear_mm = 0.0; ///< distance from an edge that is beyond any rounding
    /// Face of the previous point, which is mostly that of the next one, too. Threads share it; a wrong one
    /// only costs time.
    mutable std::atomic<unsigned> latest = 0;

    /// Replaces `out` by the faces (at least one) that hold p within same_place_mm. p must be in the hull.
    void faces_at(point p, std::vector<unsigned>& out) const;
    /// Returns the face that holds p if p keeps clear of its edges. Checks only the face of the previous
    /// point; if it returns none, use faces_at().
    std::optional<unsigned> clear_face(point p) const noexcept;
    /// Returns true if p also keeps clear of all segments between the tactors of a face.
    bool clear_of_diagonals(unsigned face, point p) const noexcept;

    /// Returns the rank of the tactor nearest to p.
    unsigned nearest_tactor(point p) const;
};

} // namespace v0
} // namespace tactor

namespace tactor::detail {

/// The region beyond an edge of the hull: more than `reach` in the direction `out`, which has length 1.
struct hull_side {
    point out;
    double reach = 0.0;
};

/// Returns the sides of the hull. If all tactors are in one line, the hull is that line: its two sides and
/// two ends.
std::vector<hull_side> hull_sides(const layout::impl& l);

} // namespace tactor::detail
