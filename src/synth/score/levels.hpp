// SPDX-License-Identifier: MIT
/// \file
/// Levels of the tactors, their limits, and the boost of actuators that rise slowly.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <tactor/error.hpp>

#include "synth/score/score.hpp"

namespace tactor::synth {

/// Error of a score that is too loud.
struct level_error : error {
    level_error(const error& e, double by_db) : error(e), over_db(by_db) {}

    double over_db; ///< amount by which this score is too loud, above 0; a weaker one may have other faults
};

/// Frequency at which the levels of tactors with thresholds at several frequencies hold. A factor applies at
/// other carriers.
inline constexpr double reference_hz = 250.0;

/// Converts an amplitude to dBFS.
double in_db(double amplitude);

/// Returns the gain of each tactor. For unmeasured_tactors() it is full scale, and they must not sound.
/// \throws level_error for levels over full scale; error (bad_input).
std::vector<tactor_level> tactor_levels(const array& a, const render_options& o);

/// Returns the tactors without a threshold if the level is in dB SL.
std::vector<std::size_t> unmeasured_tactors(const array& a, const render_options& o);

/// Throws error (bad_input), because the tactor has no threshold.
[[noreturn]] void refuse_unmeasured(const array& a, std::size_t i, const render_options& o);

/// Returns the factor on the gain of a tactor with a sensation level, at a carrier other than reference_hz.
double threshold_factor(const tactor_spec& t, double hz);

/// Returns the greatest peak that a tactor may have, linear: its max_dbfs or full scale, plus the noise of
/// last digits.
double tactor_limit(const array& a, std::size_t i);

/// Returns, for tactors 0 ... `tactors` - 1, the greatest amplitude over all samples of a continuous plan; it
/// is linear between samples.
/// \throws error (bad_input) for a tactor that the array does not have, and an amplitude that is not finite.
std::vector<double> continuous_peaks(const plan& p, std::size_t tactors);

/// Returns upper bounds of continuous_peaks() without reading samples: the greatest intensity for all
/// tactors. Empty if the intensity may not be a bound.
std::vector<double> continuous_bounds(const plan& p, std::size_t tactors);

/// Weakens the score if `o` requests it: then no tactor exceeds the requested level, and sums exceed no
/// tactor's limit unless an item exceeds it alone. Compares the level of each tactor, summed over items that
/// sound together, with its limit and with full scale. These levels are bounds, not samples, also for
/// continuous strokes. Returns the greatest level of each tactor, linear. Tactors without a measured
/// threshold must not be driven; their gain becomes 0.
/// \pre The items of the score are measured, by start.
/// \throws level_error with the tactor's line; error (bad_input).
std::vector<double> check_peaks(const std::shared_ptr<score::impl>& made, const array& a,
                                const render_options& o);

/// Adds a second burst over the first half cycles of the carrier, so that actuators of tactors with a rise_s
/// reach a burst's strength as soon as the tactor's limit allows. Only for bursts that sound alone on their
/// tactor. `peaks`: greatest level of each tactor before, linear; a boost may use the rest up to its limit.
/// Returns true if there are new items, which are at the end.
bool boost_rises(score::impl& s, const array& a, const std::vector<double>& peaks);

} // namespace tactor::synth
