// SPDX-License-Identifier: MIT
// Limits of arrays and strokes: a number beyond them is a slip of the pen.
#pragma once

namespace tactor::detail {

inline constexpr unsigned max_tactors = 16384;

/// Channels that a PCM or a WAV file can have; a file that names a channel must stay below.
/// Channels that only follow from the index may go on to max_tactors: such an array can be planned and
/// rendered, if not played.
inline constexpr unsigned max_channels = 1024;

/// Coordinates and lengths beyond a kilometre are slips of the unit.
inline constexpr double max_mm = 1e6;

/// 50 us: a device that is asked for less only keeps a processor busy. No card offers it, but null does.
constexpr unsigned least_period_frames(unsigned rate)
{
    constexpr unsigned periods_a_second = 20'000;
    return rate / periods_a_second + (rate % periods_a_second != 0 ? 1 : 0);
}

inline constexpr double min_db = -200.0; ///< below the noise of any converter
inline constexpr double max_gain_db = 60.0;

inline constexpr double longest_stroke_s = 86400.0;

/// Least speed of a profile: its slowest place takes no longer than somebody can wait for it.
inline constexpr double least_speed_mm_s = 1e-6;

/// Intensity is a factor near 1; more than this is a slip.
inline constexpr double max_intensity = 1000.0;

} // namespace tactor::detail
