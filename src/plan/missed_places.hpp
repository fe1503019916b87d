// SPDX-License-Identifier: MIT
/// \file
/// Places outside the triangle of their three tactors, as faces_kind::nearest may choose them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// Count of such places in a plan.
class missed_places {
public:
    /// Counts a burst, or a sample of a curve.
    void add(const layout& l, const burst& b);
    /// Counts the samples of a curve, some 4000 if it has more.
    void add(const layout& l, const curve& c);

    /// Returns the plan's warning; empty if there are none. `what` names a place: burst, sample.
    std::string warning(std::string_view what) const;

private:
    std::size_t all_ = 0;
    std::size_t missed_ = 0;
    std::size_t in_line_ = 0; ///< of these, with the three tactors in one line
    point first_ = {};
};

/// Warns of faces that miss their places, and of faces that the algorithm does not use. `missed` has counted
/// the bursts.
void warn_of_faces(const layout& l, const plan_options& o, missed_places& missed, plan& p);

} // namespace tactor::detail
