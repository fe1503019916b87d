// SPDX-License-Identifier: MIT
/// \file
/// What an array file or a configuration file says: see tactor.toml(5).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/lines.hpp>

namespace tactor {
inline namespace v0 {

/// [output]: the PCM. Anything not said is chosen by the program.
struct output_settings {
    std::optional<std::string> pcm = {};        ///< ALSA name; check others' by require_device_name()
    source_place pcm_at = {};                   ///< where the file says it
    bool pcm_included = false;                  ///< said in a file that the one read names under [array]
    std::optional<unsigned> rate = {};          ///< Hz, 8000 to 768000
    std::optional<unsigned> channels = {};      ///< exact channel count
    std::optional<unsigned> period_frames = {}; ///< frames in a period, 50 us at least
    std::optional<unsigned> periods = {};       ///< periods in the buffer, >= 2
};

/// [sync]: triggers out and in.
struct sync_settings {
    std::optional<gpio_line_name> out = {};
    double pulse_s = 0.005;
    std::optional<unsigned> channel = {}; ///< marker on a spare PCM channel
    std::optional<gpio_line_name> in = {};
    edge_kind edge = edge_kind::rising;
    double debounce_s = 0.001; ///< an edge that follows another within this time is dropped
    pull_kind pull = pull_kind::as_is;
};

/// [limits]: see drive_limits. Values that are not given are the defaults there.
struct limit_settings {
    std::optional<double> power_dbfs = {};
    std::optional<double> max_drive_s = {};
    std::optional<double> window_s = {};
};

/// A value of a table whose names only a program knows: [defaults], [serve]. The program checks names and
/// values.
struct said_value {
    std::string name = {}; ///< as the file writes it
    std::variant<std::monostate, bool, double, std::string> said = {};
    bool in_list = false;      ///< an entry of a list; each entry is one of these
    source_place at = {};      ///< of the value
    source_place name_at = {}; ///< of the name

    friend bool operator==(const said_value& a, const said_value& b)
    {
        return a.name == b.name && a.said == b.said && a.in_list == b.in_list;
    }
};

/// [[calibration.tactor]]: how a threshold was found.
struct calibrated_tactor {
    unsigned tactor = 0;
    std::optional<double> threshold_dbfs = {}; ///< nothing: not felt
    std::optional<double> sd_db = {};
    unsigned trials = 0;

    friend bool operator==(const calibrated_tactor&, const calibrated_tactor&) = default;
};

/// [calibration] of an array file: whose thresholds it has, and how they were measured.
struct calibration_origin {
    std::string participant = {};
    double carrier_hz = 0.0;
    bool simulated = false;
    std::string method = {};                ///< "staircase" or "adjustment"
    std::optional<std::string> rule = {};   ///< "1up3down" or "1up2down", of a staircase
    double interval_s = 0.0;                ///< how long each sounded
    std::optional<bool> feedback = {};      ///< whether the participant was told what was right
    std::optional<std::string> masker = {}; ///< the masking noise in words
    std::optional<std::string> date = {};   ///< on which it began, UTC
    std::optional<unsigned> seed = {};
    std::vector<calibrated_tactor> tactors = {};

    friend bool operator==(const calibration_origin&, const calibration_origin&) = default;
};

/// All that an array file or a configuration may say.
struct setup {
    std::optional<tactor::array> array = {};
    output_settings output = {};
    std::optional<amplifier_settings> amplifier = {};
    std::optional<sync_settings> sync = {};
    std::optional<limit_settings> limits = {};
    std::optional<calibration_origin> calibration = {};
    /// [defaults]: each name once; what an included file says comes first.
    std::vector<said_value> defaults = {};
    /// [serve]: names in the order of the file.
    std::vector<said_value> serve = {};
};

/// Reads an array or configuration file. May block on the file system.
/// \throws error (bad_input) with file, line and column; an unknown key names the nearest known one.
[[nodiscard]] TACTOR_API setup load_setup(const std::filesystem::path& file);

/// The same from text; `name` stands for the file in messages, relative names in it are resolved
/// against the current directory.
[[nodiscard]] TACTOR_API setup parse_setup(std::string_view toml, const std::string& name);

} // namespace v0
} // namespace tactor
