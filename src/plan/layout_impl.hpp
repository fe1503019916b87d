// SPDX-License-Identifier: MIT
/// \file
/// What a layout knows. Inside, tactors go by rank, their order by row and then by column, so that
/// nothing depends on the order in which a file lists them.
#pragma once

#include <utility>
#include <vector>

#include <tactor/phantom.hpp>

#include "plan/box_index.hpp"

namespace tactor {

struct layout::impl {
    std::vector<point> places;                   ///< by index
    std::vector<std::vector<unsigned>> by_index; ///< faces for the public

    std::vector<point> points;      ///< by rank
    std::vector<unsigned> index_of; ///< rank to index
    /// Rings of ranks with positive turn, each from its lowest rank. Where all tactors are in one line:
    /// pairs of neighbours, or the one tactor.
    std::vector<std::vector<unsigned>> faces;
    std::vector<point> hull;                  ///< corners with positive turn; none for a line
    std::vector<std::pair<point, point>> rim; ///< edges of the hull, or the line's segments
    double pitch_mm = 0.0;

    detail::box_index face_index;
    detail::box_index rim_index;
    detail::box_index tactor_index;

    static impl build(const array& a);

    /// Replaces `out` by the faces that hold p within same_place_mm; never none. p must be in the hull.
    void faces_at(point p, std::vector<unsigned>& out) const;
    bool face_holds(unsigned face, point p, double margin_mm) const;

    /// Rank of the tactor nearest to p.
    unsigned nearest_tactor(point p) const;
    bool in_hull(point p) const;
    point nearest_in_hull(point p) const;
};

} // namespace tactor
