// SPDX-License-Identifier: MIT
/// \file
/// The wiring walk: one tactor after another, and the channel map that the answers give.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "core/path/shape.hpp"

namespace tactor::session {

/// Returns three bursts on one tactor.
plan walk_plan(const array& a, unsigned tactor, double carrier_hz);

/// Returns walk_plan() for all tactors, one after the other.
std::vector<placed_plan> walk_plans(const array& a, double carrier_hz);

/// Places at which each tactor's channel was felt, by tactor: the number of a tactor, or nothing if it was
/// not felt.
using walk_answers = std::vector<std::optional<unsigned>>;

struct walk_verdict {
    std::vector<std::string> problems; ///< why there is no map; empty: there is
    std::vector<unsigned> channels;    ///< of each tactor, as it should be
    bool changed = false;              ///< whether that is another map than the array's
};

/// A map is made only of answers that name each tactor once.
walk_verdict judge(const array& a, const walk_answers& felt);

/// Returns the smallest rectangle with all tactors.
detail::box find_bounds(const array& a);

/// Returns the numbers of the tactors, about where these are; no line longer than 79 columns.
std::string numbered_map(const array& a);

} // namespace tactor::session
