// SPDX-License-Identifier: MIT
/// \file
/// What the plans of a piece do at one time.
#pragma once

#include <optional>
#include <vector>

#include <tactor/tactor.hpp>

namespace tactor::cli {

struct instant {
    std::vector<double> levels;  ///< per tactor, linear, 1 is the intensity asked for
    std::optional<point> target; ///< where the phantom is
};

/// Looks a time of a piece up in its plans. `starts_s`: start of each plan.
instant at_time(const std::vector<placed_plan>& plans, const std::vector<double>& starts_s,
                std::size_t tactors, double t_s);

} // namespace tactor::cli
