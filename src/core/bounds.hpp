// SPDX-License-Identifier: MIT
/// \file
/// Limits of arrays and strokes, and bounds of the numbers that users may set. All front ends use the same
/// bounds. Where a bound depends on other numbers, the planner checks a narrower one.
#pragma once

namespace tactor::detail {

/// Most channels of a PCM or a WAV file, and most tactors of an array.
inline constexpr unsigned max_channels = 1024;

/// Greatest coordinate or length, mm. More than a kilometre is a mistake in the unit.
inline constexpr double max_mm = 1e6;

/// Returns the number of frames in 50 us, the shortest period that tactor accepts. No card offers shorter
/// periods. ALSA's null device does, but they only keep a processor busy.
constexpr unsigned min_period_frames(unsigned rate)
{
    constexpr unsigned periods_a_second = 20'000;
    return rate / periods_a_second + (rate % periods_a_second != 0 ? 1 : 0);
}

inline constexpr double min_db = -200.0; ///< below the noise of any converter
inline constexpr double max_gain_db = 60.0;
inline constexpr double max_displacement_um = 10000.0;

/// Largest difference between two times that count as equal, s.
inline constexpr double same_time_s = 1e-9;

inline constexpr double longest_stroke_s = 86400.0;

/// Lowest speed in a speed profile. It limits the time that a stroke spends at its slowest place.
inline constexpr double least_speed_mm_s = 1e-6;

/// Greatest intensity. It stands for the requested level, which nothing exceeds.
inline constexpr double max_intensity = 1.0;

/// Smallest and largest allowed number.
struct bounds {
    double low = 0.0;
    double high = 0.0;
    bool above_low = false; ///< true if `low` itself is not allowed

    constexpr bool holds(double v) const noexcept { return v <= high && (above_low ? v > low : v >= low); }
};

} // namespace tactor::detail

namespace tactor::detail::bounds_of {

inline constexpr bounds duration_s{0.001, longest_stroke_s};
inline constexpr bounds speed_mm_s{0.001, 100000.0};
inline constexpr bounds soa_s{-1e9, 1e9}; // the planner checks narrower bounds, from the timing law
inline constexpr bounds burst_s{0.0001, 10.0};
inline constexpr bounds min_duration_s{0.0001, 10.0};
inline constexpr bounds slope{0.01, 0.99};
inline constexpr bounds intercept_s{0.001, 10.0};
inline constexpr bounds margin_mm{0.0, max_mm};
inline constexpr bounds carrier_hz{1.0, 384000.0}; // highest: half of the highest sample rate
inline constexpr bounds seed{0.0, 0x1p53};         // highest: the largest exact integer in JSON
inline constexpr bounds texture_mm{0.0, max_mm};   // 0 means the whole path
inline constexpr bounds am_hz{0.0, 20000.0};
inline constexpr bounds ramp_s{0.0, 10.0}; // also applies to attack and release
inline constexpr bounds part{0.0, 1.0};
inline constexpr bounds level_dbfs{min_db, 0.0};
inline constexpr bounds sl_db{-60.0, 100.0};
inline constexpr bounds stevens_exponent{0.1, 3.0};
inline constexpr bounds intensity_max{0.001, 1e6};

inline constexpr bounds people{2.0, 100000.0};
inline constexpr bounds spread_seed{0.0, 4294967295.0};
inline constexpr bounds spread_sigma{1.0, 100.0};
inline constexpr bounds spread_threshold_db{0.0, 60.0};
inline constexpr bounds spread_place_mm{0.0, 1000.0};

inline constexpr bounds rate_hz{8000.0, 768000.0};
inline constexpr bounds device_channels{1.0, double{max_channels}};
inline constexpr bounds latency_ms{0.1, 10000.0};
inline constexpr bounds period_frames{1.0, 1U << 20U};
inline constexpr bounds periods{2.0, 1024.0};
inline constexpr bounds reopen_s{0.0, 1e9};
inline constexpr bounds sync_delay_ms{0.0, 10000.0};
inline constexpr bounds smooth_s{0.0, 1.0};
inline constexpr bounds timeout_s{0.001, longest_stroke_s}; // also for the longest time of a live stroke
inline constexpr bounds masker_dbfs{-120.0, 0.0};
inline constexpr bounds interval_s{0.05, 4.0}; // duration of an interval in threshold measurements
inline constexpr bounds marker_channel{0.0, max_channels - 1.0};
inline constexpr bounds marker_s{1e-6, 10.0};

// Bounds that protect people.
inline constexpr bounds power_dbfs{-120.0, 60.0};
inline constexpr bounds drive_s{0.1, 3600.0}; // longest drive; also the window for drive time

} // namespace tactor::detail::bounds_of
