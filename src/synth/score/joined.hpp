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

/// Joins scores of one array that have the same rate, channels and limits; a score may be a joined one. In
/// the order of time, each begins at the end of the one before it or later. It keeps its own level, phase and
/// envelope: its samples are those that it has alone. Limits act on the whole. \pre There is a score.
score join_scores(const std::vector<placed_score>& parts);

/// Length of a code in bits: the start bit, and eight bits of the number.
inline constexpr unsigned code_bits = 9;

/// Makes a score that sends a number on a channel without a tactor, for joining or alone: a start bit and the
/// number's bits, least significant first, each `bit_frames` long, a set one at 0.5 of full scale. It is no
/// stroke: no sync pulse marks it. Array, rate and channels are those of `like`.
score make_code(const score& like, unsigned channel, std::uint64_t bit_frames, unsigned number);

} // namespace tactor::synth
