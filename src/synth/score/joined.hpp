// SPDX-License-Identifier: MIT
/// \file
/// Scores one after the other as one score, exact to the frame.
#pragma once

#include <cstdint>
#include <vector>

#include <tactor/render.hpp>

namespace tactor::synth {

/// A score, and the frame at which it begins.
struct placed_score {
    tactor::score score;
    std::uint64_t start = 0;
};

/// Joins scores of one array that have the same rate, channels and limits. Each begins at the end of the one
/// before it or later, and keeps its own level, phase and envelope: its samples are those that it has alone.
/// Limits act on the whole. \pre There is a score.
score join_scores(const std::vector<placed_score>& parts);

} // namespace tactor::synth
