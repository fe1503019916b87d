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

/// Strokes, and options of strokes, plans, sound and the device, as the user gave them before any file is
/// read.
struct settings : options::wishes {
    std::vector<std::string> strokes = {}; ///< STROKE arguments
};

/// The configuration that applies, with what the file of --array says.
struct environment {
    setup config;
    options::serve_settings serve; ///< [serve] of both
    std::string config_name;       ///< file it came from; empty: none
    array tactors;
    std::string array_file;  ///< that the array came from; empty: it is a preset of its name
    std::string array_doubt; ///< warning about a preset in place of the configuration's array; else empty
    std::optional<unsigned> plan_channels = {};         ///< of the plan that the array came from
    std::map<std::string, files::plan_file> plans = {}; ///< STROKE arguments that are planned already
    std::vector<stroke> standard_input = {};            ///< strokes of the STROKE "-", unless it is a plan
};

/// Reads the configuration (--config, $TACTOR_CONFIG, the user's, the system's: the first that exists),
/// fills options that nobody gave from its [defaults], reads the STROKEs that are plans and standard input
/// where "-" is one, and finds the array: --array, the configuration's, the first plan's, or palm-3x3. Says
/// environment::array_doubt on standard error. \throws error.
environment read_environment(settings& s);

/// Returns the configuration's array if it has a preset's places. Else returns the preset, and notes
/// environment::array_doubt if there is another array.
array use_preset(array preset, environment& e);

/// Highest level of a service's clients.
struct ceiling {
    double dbfs = 0.0;
    std::string from = {}; ///< key and place in the file that says so
};

/// Returns the ceiling that the files say: max_level_dbfs, else the level of [defaults], else the usual one.
ceiling find_ceiling(const environment& e);

/// Returns "-40 dBFS (max_level_dbfs, tactor.toml:4:18)".
std::string ceiling_text(const ceiling& c);

/// Returns true if `name` is one of these.
bool is_preset(const std::vector<std::string>& presets, const std::string& name);

/// Settles rate and channel count: the options, else the configuration, else the defaults.
render_options settle_render(const settings& s, const environment& e);

/// Returns a sentence if a plan has another carrier than [calibration], to which a single threshold of the
/// array belongs; else nothing.
std::string other_carrier(const environment& e, std::span<const plan* const> plans);

/// Says this once about all plans, if levels are above thresholds.
void tell_of_other_carrier(const environment& e, const render_options& r, std::span<const score> scores);

} // namespace tactor::session
