// SPDX-License-Identifier: MIT
/// \file
/// The phantom of a target that moves on: mostly its tactors are those of the place before.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tactor/phantom.hpp>

#include "plan/faces/face_rules.hpp"

namespace tactor::detail {

/// Where a model takes the same tactors: three in a disc, or three or two on what of a segment between
/// tactors lies in a disc. Belongs to one reader.
struct same_tactors {
    point centre = {};
    double radius_mm = 0.0;                    ///< 0: nothing is known
    rank_triple ranks = {};                    ///< in the model's order
    std::array<std::uint8_t, 3> by_index = {}; ///< places in `ranks`, by the tactors' indices
    unsigned count = 3;                        ///< 2: they are the ends of the segment
    bool on_segment = false;                   ///< not in all of the disc
    std::array<point, 2> ends = {};            ///< of the segment
    unsigned in_vain = 0;                      ///< so many next places are not asked about

    bool holds(point p) const noexcept
    {
        const double dx = p.x_mm - centre.x_mm;
        const double dy = p.y_mm - centre.y_mm;
        return dx * dx + dy * dy < radius_mm * radius_mm && (!on_segment || is_on_segment(p));
    }

private:
    bool is_on_segment(point p) const noexcept;
};

/// A model that takes three tactors nearly everywhere, and on a segment between two of them the same three or
/// those two.
class model_of_three : public phantom_model {
public:
    /// The three tactors that it takes at p and around it; returns how far around, mm. 0 where it does not
    /// take three at p, or where p is on the border between two choices.
    virtual double three_around(point p, rank_triple& three) const = 0;
    /// What weights() gives them, in their order, within that disc.
    virtual std::array<double, 3> amplitudes(const rank_triple& three, point p, double a_v) const = 0;

    /// How many tactors it takes, and which, at p, which is on the segment between the two `on` and on no
    /// tactor: those two, or three; 0 where others may come a little farther along it. `faces` hold p.
    virtual unsigned taken_along(const std::vector<unsigned>& faces, rank_pair on, point p,
                                 rank_triple& taken) const = 0;
    /// What weights() gives to two, within that.
    virtual std::array<double, 2> amplitudes_of_two(const rank_pair& two, point p, double a_v) const;
};

/// The drives that weights() gives at p, which `seen` holds; a_v > 0.
void drives_of_same(const model_of_three& m, const layout& l, const same_tactors& seen, point p, double a_v,
                    std::vector<drive>& out);

/// Makes `seen` a disc around p, or a part of the segment that p is on, if there is one; p is in the array.
void look_around(const model_of_three& m, const layout& l, point p, same_tactors& seen);

/// How far p may move until it comes near a line through two tactors of the face; p keeps clear of all these
/// lines. With `by_distance` also: until it comes near a place where the order of its tactors' distances
/// changes. Not above 0: it may not move.
double free_mm(const layout::impl& l, unsigned face, point p, bool by_distance);

/// How far p, which is on a segment between two tactors and on no other segment of the faces that hold it,
/// may move along it until it comes near another one. Not above 0: it may not.
double free_along_mm(const layout::impl& l, const std::vector<unsigned>& faces, rank_pair on, point p);

} // namespace tactor::detail
