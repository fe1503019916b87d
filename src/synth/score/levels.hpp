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

    double over_db; ///< excess of this score, dB, above 0; a quieter score may have other faults
};

/// Frequency to which levels refer if tactors have thresholds at several frequencies. At other carriers
/// threshold_factor() applies.
inline constexpr double reference_hz = 250.0;

/// Converts an amplitude to dBFS.
double in_db(double amplitude);

/// Returns the gain of each tactor. It is full scale for unmeasured_tactors(), which must not sound.
/// \throws level_error for levels over full scale; error (bad_input).
std::vector<tactor_level> tactor_levels(const array& a, const render_options& o);

/// Returns the tactors without a threshold if the level is in dB SL.
std::vector<std::size_t> unmeasured_tactors(const array& a, const render_options& o);

/// Throws error (bad_input), because the tactor has no threshold.
[[noreturn]] void refuse_unmeasured(const array& a, std::size_t i, const render_options& o);

/// Returns the factor on the gain of a tactor with a sensation level, at a carrier other than reference_hz.
double threshold_factor(const tactor_spec& t, double hz);

/// Returns the greatest peak that a tactor may have, linear: its max_dbfs or full scale, plus a margin for
/// rounding.
double tactor_limit(const array& a, std::size_t i);

/// Returns the greatest amplitude of each of the first `tactors` tactors over all samples of a continuous
/// plan. The amplitude is linear between samples.
/// \throws error (bad_input) for a tactor that the array does not have, and an amplitude that is not finite.
std::vector<double> continuous_peaks(const plan& p, std::size_t tactors);

/// Returns upper bounds of continuous_peaks() without reading samples: the greatest intensity, for each
/// tactor. Empty if the intensity is not known to be a bound.
std::vector<double> continuous_bounds(const plan& p, std::size_t tactors);

/// Compares the level of each tactor, summed over items that sound together, with its limit and with full
/// scale. These levels are upper bounds, not samples. If `o` requests it, first weakens the score: then no
/// tactor exceeds the requested level, and no sum exceeds a tactor's limit unless a single item does. Sets
/// the gain of tactors without a measured threshold to 0; they must not be driven. Returns the greatest level
/// of each tactor, linear.
/// \pre end_items() has put the items of the score in order.
/// \throws level_error with the tactor's line; error (bad_input).
std::vector<double> check_peaks(const std::shared_ptr<score::impl>& made, const array& a,
                                const render_options& o);

/// Boosts bursts on tactors with a rise_s: a second burst over the first half cycles of the carrier makes the
/// slow actuator reach the burst's strength as soon as the tactor's limit allows. Boosts only bursts that
/// sound alone on their tactor. `peaks`: greatest level of each tactor before, linear; a boost may use the
/// headroom up to the limit. Appends the new items at the end. Returns true if there are any.
bool boost_rises(score::impl& s, const array& a, const std::vector<double>& peaks);

} // namespace tactor::synth
