// SPDX-License-Identifier: MIT
/// \file
/// How strongly each tactor is driven, and whether it may be.
#pragma once

#include <string_view>
#include <vector>

#include "synth/score.hpp"

namespace tactor::synth {

/// Gain of each tactor. \throws error (bad_input) for levels over full scale and missing thresholds.
std::vector<tactor_level> tactor_levels(const array& a, const render_options& o);

/// Greatest peak that a tactor may have, linear: its max_dbfs or full scale, and the noise of last digits.
double tactor_limit(const array& a, std::size_t i);

/// \throws error (bad_input): the tactor's line in the array file and number, why and hint.
[[noreturn]] void refuse_tactor(const array& a, std::size_t i, std::string_view why, std::string_view hint);

/// Compares what the items ask of each tactor, added up where they sound together, with its limit and with
/// full scale; continuous strokes too are bounded, not sampled. \throws error (bad_input) with the tactor's
/// line.
void check_peaks(const score::impl& s, const array& a, const render_options& o);

} // namespace tactor::synth
