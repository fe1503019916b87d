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

/// [serve]: what tactor serve listens on and allows. Values that are not given are that program's defaults.
struct serve_settings {
    std::optional<std::string> socket = {}; ///< path of the Unix socket
    std::optional<std::string> tcp = {};    ///< "[HOST:]PORT", as for osc and http
    std::optional<std::string> osc = {};
    std::optional<std::string> http = {};
    std::optional<std::string> token_file = {};
    std::vector<std::string> allow_hosts = {};
    std::vector<std::string> osc_peers = {};
    std::optional<double> max_level_dbfs = {};
    std::optional<double> idle_stop_s = {};
    std::optional<unsigned> max_clients = {};
    std::optional<unsigned> kept_clients = {};     ///< of these, places for the Unix socket alone
    std::optional<unsigned> max_strokes = {};      ///< of one client at once
    std::optional<unsigned> max_live_strokes = {}; ///< of these, live ones
    std::optional<unsigned> max_points_per_s = {}; ///< of one client
    std::optional<double> max_stroke_s = {};
    std::optional<unsigned> max_message_bytes = {};
    std::optional<unsigned> max_nesting = {};
    std::optional<double> max_message_s = {};
    std::optional<unsigned> max_unread_bytes = {};         ///< that wait for one client
    std::optional<unsigned> max_all_unread_bytes = {};     ///< that wait for all together
    std::optional<unsigned> max_all_unfinished_bytes = {}; ///< of messages of all that have not come whole
};

/// A value of [defaults], for an option of the tool where nothing else is said. The program that has the
/// options checks names and values.
struct default_value {
    std::string name = {}; ///< as the file writes it
    std::variant<std::monostate, bool, double, std::string> said = {};
    source_place at = {};      ///< of the value
    source_place name_at = {}; ///< of the name

    friend bool operator==(const default_value& a, const default_value& b)
    {
        return a.name == b.name && a.said == b.said;
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
    std::optional<serve_settings> serve = {};
    std::optional<calibration_origin> calibration = {};
    std::vector<default_value> defaults = {}; ///< each name once; what an included file says comes first
};

/// Reads an array or configuration file. May block on the file system.
/// \throws error (bad_input) with file, line and column; an unknown key names the nearest known one.
[[nodiscard]] TACTOR_API setup load_setup(const std::filesystem::path& file);

/// The same from text; `name` stands for the file in messages, relative names in it are resolved
/// against the current directory.
[[nodiscard]] TACTOR_API setup parse_setup(std::string_view toml, const std::string& name);

} // namespace v0
} // namespace tactor
