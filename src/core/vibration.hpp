// SPDX-License-Identifier: MIT
/// \file
/// Vibrations described by envelopes, as in .haptic and AHAP files.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tactor/waveform.hpp>

namespace tactor::detail {

/// Frequency (0 to 1) of a vibration without a frequency of its own.
inline constexpr double usual_frequency = 0.5;

/// Returns the value at a time, or `without` if the list is empty. At a step, returns the value after the
/// step. O(log n).
double value_at(const std::vector<timed_value>& all, double t_s, double without);

/// Returns the carrier frequency in hertz for a frequency from 0 to 1.
double carrier_hz(const actuator_numbers& a, double frequency);
/// Returns the frequency of an emphasis in hertz, for a frequency from 0 to 1.
double emphasis_hz(const actuator_numbers& a, double frequency);

/// Returns the duration of emphasis i if nothing cuts it short.
double emphasis_s(const vibration& v, std::size_t i);
/// Returns the index of the last emphasis that begins at or before a time, if any. O(log n).
std::optional<std::size_t> last_emphasis(const vibration& v, double t_s);
/// Returns the end of emphasis i. The end of the vibration may cut the emphasis short. So may the next
/// emphasis, unless the actuator belongs to the format (AHAP).
double emphasis_end_s(const vibration& v, std::size_t i);
/// Returns the index of the emphasis that plays at a time, if any. O(log n).
std::optional<std::size_t> find_emphasis(const vibration& v, double t_s);

/// Checks a vibration from any source.
/// \throws error (bad_input) about `name`.
void check_vibration(const vibration& v, const std::string& name);

} // namespace tactor::detail
