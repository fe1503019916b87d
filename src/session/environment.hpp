// SPDX-License-Identifier: MIT
/// \file
/// Settings that are known before a stroke is read: configuration, array, rate, channels and limits.
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

/// Configuration that applies, including the file of --array.
struct environment {
    setup config;
    options::serve_settings serve; ///< [serve] of the configuration and of the array file
    std::string config_name;       ///< file of the configuration; empty if there is none
    array tactors;
    std::string array_file;  ///< file of the array; empty if the array is a preset
    std::string array_doubt; ///< warning if a preset replaces the configuration's array; else empty
    std::optional<unsigned> plan_channels = {};         ///< channels of the plan from which the array came
    std::map<std::string, files::plan_file> plans = {}; ///< STROKE arguments that are plans
    std::vector<stroke> standard_input = {}; ///< strokes from standard input (STROKE "-"), unless a plan
};

/// Reads the configuration, which is the first that exists of --config, $TACTOR_CONFIG, the user's file and
/// the system's file. Sets options that the user did not set from its [defaults]. Reads plans among the
/// STROKEs, and standard input for "-". Finds the array: that of --array, else the configuration's, else the
/// first plan's, else palm-3x3. Prints environment::array_doubt on standard error.
/// \throws error.
environment read_environment(settings& s);

/// Returns the configuration's array if its tactors are at the places of a preset. Otherwise returns the
/// preset, and sets environment::array_doubt if the configuration has another array.
array resolve_preset(array preset, environment& e);

/// Highest level that clients of a service may use.
struct ceiling {
    double dbfs = 0.0;
    std::string from = {}; ///< key and place in the file that sets it
};

/// Returns the ceiling: max_level_dbfs of the files, else the level in [defaults], else the built-in default.
ceiling find_ceiling(const environment& e);

/// Returns a ceiling as text: "-40 dBFS (max_level_dbfs, tactor.toml:4:18)".
std::string ceiling_text(const ceiling& c);

/// Returns true if `name` is in the list.
bool is_preset(const std::vector<std::string>& presets, const std::string& name);

/// Determines rate and number of channels from the options, the configuration or the defaults, in this order.
render_options find_render_options(const settings& s, const environment& e);

/// Returns a warning if a plan's carrier differs from the carrier of [calibration], at which the array's
/// single thresholds were measured; else an empty string.
std::string carrier_warning(const environment& e, std::span<const plan* const> plans);

/// Prints the warning of carrier_warning(), once for all plans, if levels are in dB above thresholds.
void warn_of_other_carrier(const environment& e, const render_options& r, std::span<const score> scores);

} // namespace tactor::session
