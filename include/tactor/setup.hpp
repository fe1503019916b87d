// SPDX-License-Identifier: MIT
/// \file
/// Contents of an array file or a configuration file, see tactor.toml(5).
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
#include <tactor/waveform.hpp>

namespace tactor {
inline namespace v0 {

/// [output]: the PCM. The program chooses missing values.
struct output_settings {
    std::optional<std::string> pcm = {}; ///< ALSA name; check names from others with require_device_name()
    source_place pcm_at = {};            ///< place of the name in its file
    bool pcm_included = false; ///< the name comes from a file that the configuration names under [array]
    std::optional<unsigned> rate = {};          ///< Hz, 8000 to 768000
    std::optional<unsigned> channels = {};      ///< exact channel count
    std::optional<unsigned> period_frames = {}; ///< frames in a period, 50 us at least
    std::optional<unsigned> periods = {};       ///< periods in the buffer, >= 2
};

/// [sync.codes]: numbers of the events of a kind.
struct code_numbering {
    std::optional<unsigned> first = {}; ///< none: the number after the last number of the kind before
    /// Parts of an event that select its number: run, motion, method, value, interval, answer. None: the
    /// parts that are usual for the kind.
    std::optional<std::vector<std::string>> by = {};
};

/// [sync] code: numbers that mark what happens in a study with people.
struct code_settings {
    std::optional<unsigned> channel = {}; ///< spare PCM channel of the pulse codes
    double bit_s = 0.002;                 ///< length of a bit on that channel
    std::string chip = {};                ///< GPIO chip; empty: no lines
    std::vector<unsigned> offsets = {};   ///< lines of this chip, least significant bit first; eight at most
    double pulse_s = 0.005;               ///< time for which the lines and the box show a number
    bool lsl = false;                     ///< markers to the Lab Streaming Layer
    std::string serial = {};              ///< port of a serial trigger box; empty: none
    unsigned baud = 115200;               ///< rate of this port, bits per second
    code_numbering stimulus = {};
    code_numbering standard = {}; ///< stimuli with the standard's value
    code_numbering caught = {};   ///< trials without a stimulus
    code_numbering answer = {};
    code_numbering made_void = {};
    source_place where = {};
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
    std::optional<code_settings> code = {};
};

/// [limits], see drive_limits. Missing values have the defaults of drive_limits.
struct limit_settings {
    std::optional<double> power_dbfs = {};
    std::optional<double> max_drive_s = {};
    std::optional<double> window_s = {};
};

/// A value of [defaults] or [serve]: tables whose names only the program knows. The program checks names and
/// values.
struct written_value {
    std::string name = {}; ///< as written in the file
    std::variant<std::monostate, bool, double, std::string> value = {};
    bool in_list = false;      ///< an entry of a list
    source_place at = {};      ///< place of the value
    source_place name_at = {}; ///< place of the name

    friend bool operator==(const written_value& a, const written_value& b)
    {
        return a.name == b.name && a.value == b.value && a.in_list == b.in_list;
    }
};

/// [[calibration.tactor]]: result of measuring one threshold.
struct calibrated_tactor {
    unsigned tactor = 0;
    std::optional<double> threshold_dbfs = {}; ///< none: not felt
    std::optional<double> sd_db = {};
    std::optional<double> posterior_sd_db = {}; ///< QUEST+, in place of sd_db
    unsigned trials = 0;

    friend bool operator==(const calibrated_tactor&, const calibrated_tactor&) = default;
};

/// [calibration] of an array file: the participant and the method of its thresholds.
struct calibration_origin {
    std::string participant = {};
    double carrier_hz = 0.0;
    bool simulated = false;
    std::string method = {};                ///< "staircase", "adjustment" or "quest"
    std::optional<std::string> rule = {};   ///< staircase: "1up3down" or "1up2down"
    double interval_s = 0.0;                ///< duration of each interval
    std::optional<bool> feedback = {};      ///< the participant was told whether each answer was right
    std::optional<std::string> masker = {}; ///< description of the masking noise
    std::optional<std::string> date = {};   ///< start of the session, UTC
    std::optional<unsigned> seed = {};
    std::vector<calibrated_tactor> tactors = {};

    friend bool operator==(const calibration_origin&, const calibration_origin&) = default;
};

/// Contents of an array file or a configuration.
struct setup {
    std::optional<tactor::array> array = {};
    output_settings output = {};
    std::optional<amplifier_settings> amplifier = {};
    std::optional<sync_settings> sync = {};
    std::optional<limit_settings> limits = {};
    std::optional<calibration_origin> calibration = {};
    std::optional<actuator_numbers> texture = {}; ///< [texture]
    /// [defaults]: each name once; values of an included file come first.
    std::vector<written_value> defaults = {};
    /// [serve]: in the order of the file; values of an included file come first.
    std::vector<written_value> serve = {};
};

/// Reads an array or configuration file. May block on the file system.
/// \throws error (bad_input) with file, line and column. For an unknown key it names the nearest known one.
[[nodiscard]] TACTOR_API setup load_setup(const std::filesystem::path& file);

/// Reads the same from text. `name` stands for the file in messages. Relative file names in the text count
/// from the current directory.
[[nodiscard]] TACTOR_API setup parse_setup(std::string_view toml, const std::string& name);

} // namespace v0
} // namespace tactor
