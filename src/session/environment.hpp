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

/// The configuration that applies, and the array file's own [output], [amplifier] and [sync] over it.
struct environment {
    setup config;
    options::serve_settings serve; ///< the configuration's [serve]
    std::string config_name;       ///< file it came from; empty: none
    array tactors;
    std::string array_file; ///< that the array came from; empty: it is a preset of its name
    std::optional<unsigned> plan_channels = {};         ///< of the plan that the array came from
    std::map<std::string, files::plan_file> plans = {}; ///< STROKE arguments that are planned already
    std::vector<stroke> standard_input = {};            ///< strokes of the STROKE "-", unless it is a plan
};

/// Reads the configuration (--config, $TACTOR_CONFIG, the user's, the system's: the first that exists),
/// fills options that nobody gave from its [defaults], reads the STROKEs that are plans and standard input
/// where "-" is one, and finds the array: --array, the configuration's, the first plan's, or palm-3x3.
/// \throws error.
environment read_environment(settings& s);

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
