// SPDX-License-Identifier: MIT
/// \file
/// Joins scores into a single one, exact to the frame.
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

/// Joins scores of one array with the same rate, channels and limits; a part may itself be a joined score.
/// Parts are in order of time and do not overlap. Each part keeps its level, phase and envelope, so its
/// samples are the same as if it played alone. Limits act on the whole. \pre At least one part.
score join_scores(const std::vector<placed_score>& parts);

/// Length of a code in bits: the start bit, and eight bits of the number.
inline constexpr unsigned code_bits = 9;

/// Makes a score that sends a number on a channel without a tactor: a start bit and the number's bits, least
/// significant first. Each bit is `bit_frames` long; set bits are at 0.5 of full scale. A code is not a
/// stroke, so it has no sync pulse. It has the array, rate and channels of `like`, and may be joined or
/// played alone.
score make_code(const score& like, unsigned channel, std::uint64_t bit_frames, unsigned number);

} // namespace tactor::synth
