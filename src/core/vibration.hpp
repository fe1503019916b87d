// SPDX-License-Identifier: MIT
/// \file
/// Vibrations by their envelopes, as .haptic and AHAP files have them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tactor/waveform.hpp>

namespace tactor::detail {

/// Frequency, 0 to 1, of a vibration that gives none.
inline constexpr double usual_frequency = 0.5;

/// Returns the value at a time, after a step at that time; `without` for an empty list. O(log n).
double value_at(const std::vector<timed_value>& all, double t_s, double without);

/// Returns the carrier for a frequency from 0 to 1.
double carrier_hz(const actuator_numbers& a, double frequency);
/// Returns the frequency in hertz of an emphasis.
double emphasis_hz(const actuator_numbers& a, double frequency);

/// Returns the duration of emphasis i by itself.
double emphasis_s(const vibration& v, std::size_t i);
/// Returns the last emphasis that has begun at a time, if any. O(log n).
std::optional<std::size_t> last_emphasis(const vibration& v, double t_s);
/// Returns the end of emphasis i: the next one, or the vibration's end, may cut it short.
double emphasis_end_s(const vibration& v, std::size_t i);
/// Returns the emphasis that sounds at a time, if any. O(log n).
std::optional<std::size_t> find_emphasis(const vibration& v, double t_s);

/// Checks a vibration, whoever made it.
/// \throws error (bad_input) about `name`.
void check_vibration(const vibration& v, const std::string& name);

} // namespace tactor::detail
