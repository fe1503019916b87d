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

/// A disc within which a model takes the same three tactors. Belongs to one reader.
struct same_tactors {
    point centre = {};
    double radius_mm = 0.0;                    ///< 0: nothing is known
    rank_triple three = {};                    ///< in the model's order
    std::array<std::uint8_t, 3> by_index = {}; ///< places in `three`, by the tactors' indices
    unsigned in_vain = 0;                      ///< places that will not be asked about next

    bool holds(point p) const noexcept
    {
        const double dx = p.x_mm - centre.x_mm;
        const double dy = p.y_mm - centre.y_mm;
        return dx * dx + dy * dy < radius_mm * radius_mm;
    }
};

/// A model that takes three tactors nearly everywhere.
class model_of_three : public phantom_model {
public:
    /// The three that it takes at p and around it, and how far around, mm; 0 where it takes others at p, or
    /// where p is on the border between two choices.
    virtual double three_around(point p, rank_triple& three) const = 0;
    /// What weights() gives them, in their order, within that disc.
    virtual std::array<double, 3> amplitudes(const rank_triple& three, point p, double a_v) const = 0;
};

/// What weights() gives at p, which `seen` holds; a_v > 0.
void drives_of_three(const model_of_three& m, const layout& l, const same_tactors& seen, point p, double a_v,
                     std::vector<drive>& out);

/// Makes `seen` a disc around p, which is in the array, if there is one.
void look_around(const model_of_three& m, const layout& l, point p, same_tactors& seen);

/// How far p, which keeps clear of all lines through two tactors of a face, may move until it comes near one
/// of them, or, where the order of its tactors' distances matters, near a place where that changes. Not above
/// 0: it may not.
double free_mm(const layout::impl& l, unsigned face, point p, bool by_distance);

} // namespace tactor::detail
