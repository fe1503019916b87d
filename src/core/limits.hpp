// SPDX-License-Identifier: MIT
// Limits of arrays and strokes. A number beyond them is a slip of the user.
#pragma once

namespace tactor::detail {

/// Most channels of a PCM or a WAV file, and most tactors of an array.
inline constexpr unsigned max_channels = 1024;

/// Greatest coordinate or length, mm. More than a kilometre is a mistake in the unit.
inline constexpr double max_mm = 1e6;

/// Returns the frames of 50 us. Shorter periods only keep a processor busy. No card offers them, but null
/// does.
constexpr unsigned least_period_frames(unsigned rate)
{
    constexpr unsigned periods_a_second = 20'000;
    return rate / periods_a_second + (rate % periods_a_second != 0 ? 1 : 0);
}

inline constexpr double min_db = -200.0; ///< below the noise of any converter
inline constexpr double max_gain_db = 60.0;
inline constexpr double max_displacement_um = 10000.0;

/// Times nearer than this are one time, s.
inline constexpr double same_time_s = 1e-9;

inline constexpr double longest_stroke_s = 86400.0;

/// Least speed of a profile. It bounds the time at its slowest place.
inline constexpr double least_speed_mm_s = 1e-6;

/// Greatest intensity: the level asked for, which is a ceiling.
inline constexpr double max_intensity = 1.0;

} // namespace tactor::detail
