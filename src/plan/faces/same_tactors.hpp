// SPDX-License-Identifier: MIT
/// \file
/// The phantom of a moving target, which mostly uses the tactors of the previous place.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tactor/phantom.hpp>

#include "plan/faces/face_rules.hpp"
#include "plan/faces/plane.hpp"

namespace tactor::detail {

/// Region in which a model uses the same tactors: three in a disc, or two or three on the part of a segment
/// between tactors that lies in a disc. Belongs to one reader.
struct same_tactors {
    point centre = {};
    double radius_mm = 0.0;                    ///< 0: nothing is known
    rank_triple ranks = {};                    ///< in the model's order
    std::array<std::uint8_t, 3> by_index = {}; ///< places in `ranks`, by the tactors' indices
    unsigned count = 3;                        ///< 2: they are the ends of the segment
    bool on_segment = false;                   ///< only on the segment, not in the whole disc
    std::array<point, 2> ends = {};            ///< ends of the segment
    unsigned skips = 0;                        ///< number of next places at which look_around() does nothing

    bool holds(point p) const noexcept
    {
        const double dx = p.x_mm - centre.x_mm;
        const double dy = p.y_mm - centre.y_mm;
        return dx * dx + dy * dy < radius_mm * radius_mm &&
               (!on_segment || segment_distance_mm(ends[0], ends[1], p) <= surely_on_mm);
    }

    /// Distance at which a point counts as on a segment whatever the rounding of the formula.
    static constexpr double surely_on_mm = 0.5 * same_place_mm;
};

/// A model that uses three tactors nearly everywhere; on a segment between two of them it uses the same three
/// or those two.
class model_of_three : public phantom_model {
public:
    /// Finds the three tactors that the model uses at p and around it. Returns the radius of this region, mm;
    /// 0 if the model does not use three at p, or if p is on a border.
    virtual double three_around(point p, rank_triple& three) const = 0;
    /// Returns the amplitudes that weights() gives the first `count` (2 or 3) of the ranks, in their order,
    /// within that disc or on that part of the segment.
    virtual std::array<double, 3> amplitudes(const rank_triple& ranks, unsigned count, point p,
                                             double a_v) const = 0;

    /// Returns the number of tactors that the model uses at p: 2 (those of `on`) or 3; 0 if it may use others
    /// a little farther along. p is on the segment between the two tactors `on`, and on no tactor. `faces`
    /// hold p.
    virtual unsigned taken_along(const std::vector<unsigned>& faces, rank_pair on, point p,
                                 rank_triple& taken) const = 0;
};

/// Computes the drives of weights() at a point p within `seen`; a_v > 0.
void drives_of_same(const model_of_three& m, const layout& l, const same_tactors& seen, point p, double a_v,
                    std::vector<drive>& out);

/// Makes `seen` a disc around p, or a part of the segment under p, if there is one. p is in the array.
void look_around(const model_of_three& m, const layout& l, point p, same_tactors& seen);

/// Returns the distance, mm, that p may move before it comes near a line through two tactors of the face; p
/// keeps clear of all these lines. With `by_distance` also before it comes near a place where the order of
/// its tactors' distances changes. 0 or less: it may not move.
double free_mm(const layout::impl& l, unsigned face, point p, bool by_distance);

} // namespace tactor::detail
