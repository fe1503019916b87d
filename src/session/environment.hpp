// SPDX-License-Identifier: MIT
/// \file
/// Settings before any stroke is read: configuration, array, rate, channels and limits.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactor/plan.hpp>
#include <tactor/render.hpp>
#include <tactor/tactor.hpp>

#include "files/plan/plan_json.hpp"
#include "options/option.hpp"
#include "options/serve.hpp"

namespace tactor::session {

using options::stream_options;

/// Strokes, and options of strokes, plans, sound and the device, as the user wrote them, before any file is
/// read.
struct settings : options::option_values {
    std::vector<std::string> strokes = {}; ///< STROKE arguments
};

/// Configuration that applies, with the contents of the file of --array.
struct environment {
    setup config;
    options::serve_settings serve; ///< [serve] of both files
    std::string config_name;       ///< its file; empty: none
    array tactors;
    std::string array_file;  ///< file of the array; empty: the array is a preset
    std::string array_doubt; ///< warning about a preset in place of the configuration's array; else empty
    std::optional<unsigned> plan_channels = {};         ///< channels of the plan from which the array came
    std::map<std::string, files::plan_file> plans = {}; ///< STROKE arguments that are plans
    std::vector<stroke> standard_input = {};            ///< strokes of the STROKE "-", unless it is a plan
};

/// Reads the configuration (--config, $TACTOR_CONFIG, the user's, the system's: the first that exists) and
/// sets options that the user did not set from its [defaults]. Reads plans among the STROKEs, and standard
/// input for "-". Finds the array: --array, the configuration's, the first plan's, or palm-3x3. Prints
/// environment::array_doubt on standard error.
/// \throws error.
environment read_environment(settings& s);

/// Returns the configuration's array if it has the places of a preset. Otherwise returns the preset, and
/// notes environment::array_doubt if the configuration has another array.
array use_preset(array preset, environment& e);

/// Highest level that clients of a service may use.
struct ceiling {
    double dbfs = 0.0;
    std::string from = {}; ///< key and place in the file that sets it
};

/// Returns the ceiling of the files: max_level_dbfs, else the level of [defaults], else the built-in default.
ceiling find_ceiling(const environment& e);

/// Returns "-40 dBFS (max_level_dbfs, tactor.toml:4:18)".
std::string ceiling_text(const ceiling& c);

/// Returns true if `name` is in the list.
bool is_preset(const std::vector<std::string>& presets, const std::string& name);

/// Determines rate and channel count: the options, else the configuration, else the defaults.
render_options find_render(const settings& s, const environment& e);

/// Returns a sentence if a plan's carrier differs from that of [calibration], at which the array's single
/// thresholds were measured; else nothing.
std::string other_carrier(const environment& e, std::span<const plan* const> plans);

/// Prints this sentence once for all plans, if levels are in dB above thresholds.
void tell_of_other_carrier(const environment& e, const render_options& r, std::span<const score> scores);

} // namespace tactor::session
