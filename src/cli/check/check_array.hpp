// SPDX-License-Identifier: MIT
/// \file
/// What can be known about an array without hardware.
#pragma once

#include <cstddef>
#include <vector>

#include "cli/check/finding.hpp"
#include "cli/input.hpp"

namespace tactor::cli {

/// Returns the numbers of the tactors for which `take` holds.
template <class F>
std::vector<std::size_t> tactors_where(const array& a, F&& take)
{
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (take(a.tactors[i]))
            all.push_back(i);
    return all;
}

/// Places, channels, levels, actuators, bursts, limits. Looks at values only.
std::vector<finding> check_array(const settings& s, const environment& e, const drive_limits& l);

/// Actuators against burst length and carrier: the part of check_array() that knows actuators. `rate`: Hz.
std::vector<finding> check_bursts(const plan_options& p, const array& a, unsigned rate);

} // namespace tactor::cli
