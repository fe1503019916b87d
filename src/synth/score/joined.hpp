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

/// Joins scores of one array that have the same rate, channels and limits; a score may itself be a joined
/// one. Parts are in order of time and do not overlap. Each keeps its own level, phase and envelope, so its
/// samples are the same as alone. Limits act on the whole. \pre At least one part.
score join_scores(const std::vector<placed_score>& parts);

/// Length of a code in bits: the start bit, and eight bits of the number.
inline constexpr unsigned code_bits = 9;

/// Makes a score that sends a number on a channel without a tactor, for joining or alone: a start bit and the
/// number's bits, least significant first, each `bit_frames` long, set bits at 0.5 of full scale. It is not a
/// stroke, so no sync pulse marks it. It has the array, rate and channels of `like`.
score make_code(const score& like, unsigned channel, std::uint64_t bit_frames, unsigned number);

} // namespace tactor::synth
