// SPDX-License-Identifier: MIT
/// \file
/// The wiring walk: it plays one tactor after another, and makes a channel map from the answers.
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

/// Answers by driven tactor: the number of the tactor that was felt, or nothing.
using walk_answers = std::vector<std::optional<unsigned>>;

struct walk_map {
    std::vector<std::string> problems; ///< reasons why there is no map; empty if there is a map
    std::vector<unsigned> channels;    ///< right channel of each tactor
    bool changed = false;              ///< the map differs from the array's
};

/// Makes a map if the answers name each tactor once; else lists the problems.
walk_map map_channels(const array& a, const walk_answers& felt);

/// Returns the smallest rectangle with all tactors.
detail::box find_bounds(const array& a);

/// Returns the numbers of the tactors, placed as on the array; no line is longer than 79 columns.
std::string tactor_map_text(const array& a);

} // namespace tactor::session
