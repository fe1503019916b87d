// SPDX-License-Identifier: MIT
/// \file
/// The array of tactors: the place of each tactor and how it is driven.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/error.hpp>
#include <tactor/path.hpp>

namespace tactor {
inline namespace v0 {

/// Working principle of a tactor. The principle decides which bursts the tactor can make.
enum class actuator_kind {
    unknown,
    piezo,
    voice_coil,
    lra, ///< linear resonant
    erm, ///< eccentric rotating mass
};
TACTOR_KIND(actuator_kind);

/// Detection threshold at a frequency.
struct threshold_point {
    double hz = 0.0; ///< above 0
    double dbfs = 0.0;

    friend bool operator==(const threshold_point&, const threshold_point&) = default;
};

/// A vibrating actuator. Its index is its position in array::tactors.
struct tactor_spec {
    point position = {};                       ///< centre, mm
    unsigned channel = 0;                      ///< PCM channel, from 0
    double gain_db = 0.0;                      ///< added to the level in dBFS, but not to a level in dB SL
    double max_dbfs = 0.0;                     ///< hard limit of this channel, <= 0 dBFS
    std::optional<double> threshold_dbfs = {}; ///< measured detection threshold, dBFS
    int polarity = 1;                          ///< 1, or -1 if the actuator is wired with reversed polarity
    actuator_kind actuator = actuator_kind::unknown;
    /// Thresholds at several frequencies, in ascending order of frequency. They replace threshold_dbfs.
    /// Between two frequencies the threshold in dB is linear in the logarithm of the frequency. Below the
    /// lowest and above the highest frequency, the nearest threshold counts.
    std::vector<threshold_point> thresholds = {};
    std::optional<double> rise_s = {}; ///< time until the vibration reaches 1 - 1/e of its strength, s
    source_place where = {};           ///< place in the array file, for error messages
    source_place limit_where = {};     ///< place of max_dbfs, if it is from another file than the rest
    /// Displacement of the tactor with skin on it, zero to peak, um: measured with a sine of 0 dBFS at the
    /// working carrier. Reports state this value; no sample depends on it.
    std::optional<double> displacement_um_at_0dbfs = {};
};

/// A set of tactors. A plain value.
struct array {
    std::string name = {};
    std::vector<tactor_spec> tactors = {};
    source_place where = {};
    std::string site = {}; ///< place on the body, such as "left palm"; empty: not known
    std::string up = {};   ///< direction of the upper edge on the body, such as "fingers"; empty: not known
    std::optional<point> place = {};     ///< for pictures: middle of the array, from the site's landmark, mm
    std::optional<double> turn_deg = {}; ///< for pictures: clockwise turn of the body part under the array
    std::optional<double> body_mm = {};  ///< for pictures: length of the body part, such as the hand

    /// Returns the number of channels that the array needs: the highest channel + 1.
    TACTOR_API unsigned channels() const noexcept;
};

/// Returns the threshold of a tactor at a frequency, dBFS, or nothing if none was measured.
[[nodiscard]] TACTOR_API std::optional<double> threshold_at(const tactor_spec& t, double hz);

/// Lines of a rectangular grid, each list in ascending order, mm.
struct grid_lines {
    std::vector<double> x_mm = {}; ///< columns
    std::vector<double> y_mm = {}; ///< rows
};

/// Returns the grid that the tactors form. Returns nothing unless there is a tactor wherever a column crosses
/// a row, and no other tactor. Two lines less than same_place_mm apart count as one line. A single row or a
/// single column is a grid, too.
[[nodiscard]] TACTOR_API std::optional<grid_lines> find_grid(const array& a);

/// Makes an array of rows x columns tactors. The index of a tactor is row * columns + column, its channel
/// equals its index, and tactor 0 is at (0, 0).
/// \throws error (bad_input) for no rows or columns, more than 1024 tactors, or a pitch that is not positive
///         and finite.
[[nodiscard]] TACTOR_API array make_grid(std::string name, unsigned rows, unsigned columns, double pitch_x_mm,
                                         double pitch_y_mm);

/// Returns the names of the built-in arrays: "palm-3x3" (the paper's), "palm-2x4", "dualsense", "usb-7.1".
[[nodiscard]] TACTOR_API const std::vector<std::string>& array_presets();

/// Returns a built-in array by name.
/// \throws error (bad_input) that lists the presets.
[[nodiscard]] TACTOR_API array preset_array(std::string_view name);

/// Checks the rules for every array. The array has at least one tactor. Places are finite, and no two tactors
/// share a place or a channel. Gains and limits are in range (max_dbfs <= 0, polarity 1 or -1). Channels are
/// below 1024, because no PCM has more. O(n^2).
/// \throws error (bad_input) that names the tactors and their line.
TACTOR_API void validate(const array& a);

} // namespace v0
} // namespace tactor
