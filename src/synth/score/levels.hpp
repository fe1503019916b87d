// SPDX-License-Identifier: MIT
/// \file
/// Levels of the tactors, their limits, and the boost of actuators that rise slowly.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "synth/score/score.hpp"

namespace tactor::synth {

/// Levels of tactors with thresholds at several frequencies hold at this frequency; a factor for another
/// carrier comes on top.
inline constexpr double reference_hz = 250.0;

/// Converts an amplitude to dBFS.
double in_db(double amplitude);

/// Returns the gain of each tactor; of unmeasured_tactors() that of full scale, which must not sound.
/// \throws error (bad_input) for levels over full scale.
std::vector<tactor_level> tactor_levels(const array& a, const render_options& o);

/// Returns the tactors without a threshold if the level is in dB SL.
std::vector<std::size_t> unmeasured_tactors(const array& a, const render_options& o);

/// \throws error (bad_input): the tactor has no threshold.
[[noreturn]] void refuse_unmeasured(const array& a, std::size_t i, const render_options& o);

/// Returns the factor on the gain of a tactor with a sensation level, at a carrier other than reference_hz.
double threshold_factor(const tactor_spec& t, double hz);

/// Returns the greatest peak that a tactor may have, linear: its max_dbfs or full scale, plus the noise of
/// last digits.
double tactor_limit(const array& a, std::size_t i);

/// Returns the greatest amplitude of each of so many tactors over all samples of a continuous plan; between
/// them it is linear.
/// \throws error (bad_input) for a tactor that the array does not have, and an amplitude that is not finite.
std::vector<double> continuous_peaks(const plan& p, std::size_t tactors);

/// Returns upper bounds of continuous_peaks() without a look at the samples: the greatest intensity for all.
/// Empty if the intensity is not known to be a bound.
std::vector<double> continuous_bounds(const plan& p, std::size_t tactors);

/// Weakens the score where `o` asks for that: no tactor then exceeds the level asked for, nor do sums exceed
/// a tactor's limit that nothing exceeds alone. Then compares the
/// levels that the items ask of each tactor, added up where they sound together, with its limit and with
/// full scale. For continuous strokes, too, these are bounds, not samples. Returns the greatest level of each
/// tactor, linear. Tactors that nobody measured must not be driven, and have no gain afterwards.
/// \pre The items of the score are measured, by start.
/// \throws error (bad_input) with the tactor's line.
std::vector<double> check_peaks(const std::shared_ptr<score::impl>& made, const array& a,
                                const render_options& o);

/// Lets the actuators of tactors with a rise_s reach a burst's strength as soon as the tactor's limit allows:
/// adds a second burst over the first half cycles of the carrier. Only for bursts that sound on their tactor
/// alone. `peaks`: greatest level of each tactor before, linear; the rest up to its limit may be used.
/// Returns true if there are new items, which stand at the end.
bool boost_rises(score::impl& s, const array& a, const std::vector<double>& peaks);

} // namespace tactor::synth
