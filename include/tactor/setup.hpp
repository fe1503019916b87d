// SPDX-License-Identifier: MIT
/// \file
/// What an array file or a configuration file says: see tactor.toml(5).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <tactor/api.hpp>
#include <tactor/array.hpp>

namespace tactor {

/// [output]: the PCM. Anything not said is chosen by the program.
struct output_settings {
    std::optional<std::string> pcm = {};        ///< ALSA name; another's file: see require_device_name()
    source_place pcm_at = {};                   ///< where the file says it
    bool pcm_included = false;                  ///< by a file that the one read names under [array]
    std::optional<unsigned> rate = {};          ///< Hz, 8000 to 768000
    std::optional<unsigned> channels = {};      ///< exact channel count
    std::optional<unsigned> period_frames = {}; ///< frames in a period
    std::optional<unsigned> periods = {};       ///< periods in the buffer, >= 2
};

/// A GPIO line: either chip (label or path) and offset, or a line name.
struct gpio_line_name {
    std::string chip = {};
    std::optional<unsigned> offset = {};
    std::string name = {};
    source_place where = {};
};

/// [amplifier]: the line that enables the amplifier.
struct amplifier_settings {
    gpio_line_name line = {};
    bool active_low = false;
    double settle_ms = 10.0; ///< turn-on time of the amplifier
};

/// [sync]: triggers out and in.
struct sync_settings {
    std::optional<gpio_line_name> out = {};
    double pulse_ms = 5.0;
    std::optional<unsigned> channel = {}; ///< marker on a spare PCM channel
    std::optional<gpio_line_name> in = {};
    std::string edge = "rising"; ///< "rising", "falling" or "both"
    double debounce_ms = 1.0;    ///< edges that follow another within this are dropped
    std::string pull = "as-is";  ///< "up", "down", "none" or "as-is"
};

/// [limits]: see drive_limits. Anything not said is that one's default.
struct limit_settings {
    std::optional<double> power_dbfs = {};
    std::optional<double> max_drive_s = {};
    std::optional<double> window_s = {};
};

/// All that a file may say.
struct setup {
    std::optional<array> layout = {};
    output_settings output = {};
    std::optional<amplifier_settings> amplifier = {};
    std::optional<sync_settings> sync = {};
    std::optional<limit_settings> limits = {};
    /// [defaults]: option name (without dashes) to value as text, e.g. "phantom" -> "barycentric".
    /// Only names that setup_default_names() lists.
    std::map<std::string, std::string> defaults = {};
};

/// Options that a [defaults] table may set.
TACTOR_API const std::vector<std::string>& setup_default_names();

/// Reads an array or configuration file. May block on the file system.
/// \throws error (bad_input) with file, line and column; an unknown key names the nearest known one.
TACTOR_API setup load_setup(const std::filesystem::path& file);

/// The same from text; `name` stands for the file in messages, relative names in it are resolved
/// against the current directory.
TACTOR_API setup parse_setup(std::string_view toml, const std::string& name);

/// The text of an array or configuration file with other channels, one for each tactor in order; all else in
/// it stays as it is, comments too. May block on the file system.
/// \throws error (bad_input): what load_setup() throws; no array in the file; a wrong number of channels;
///         channels that the file cannot have (two alike, more than [output] says). The text itself is
///         checked: what it says is what was asked for.
TACTOR_API std::string with_channels(const std::filesystem::path& file, std::span<const unsigned> channels);

} // namespace tactor
