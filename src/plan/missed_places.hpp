// SPDX-License-Identifier: MIT
/// \file
/// Places that the triangle of their tactors does not hold, as may be with faces_kind::nearest.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tactor/plan.hpp>

namespace tactor::detail {

/// Counts them over a plan.
class missed_places {
public:
    /// Looks at a burst, or at a sample of a curve.
    void add(const layout& l, const burst& b);
    /// Looks at a curve, at some 4000 samples where it has more.
    void add(const layout& l, const curve& c);

    /// Returns the plan's warning of them; empty if there are none. `what` is a place: burst, sample.
    std::string warning(std::string_view what) const;

private:
    std::size_t all_ = 0;
    std::size_t missed_ = 0;
    std::size_t in_line_ = 0; ///< of these, with the three tactors in one line
    point first_ = {};
};

/// Adds the plan's warnings of faces: where they miss the place, and that the algorithm does not use them.
/// `missed` has seen the bursts.
void warn_of_faces(const layout& l, const plan_options& o, missed_places& missed, plan& p);

} // namespace tactor::detail
