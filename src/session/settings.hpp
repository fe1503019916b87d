// SPDX-License-Identifier: MIT
/// \file
/// What a user asks for, before any file is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

namespace tactor::session {

/// Options of strokes, plans, sound and the device. Those that nobody gave hold the built-in default.
struct settings {
    std::vector<std::string> strokes;       ///< STROKE arguments
    std::optional<std::string> path_data;   ///< --path
    std::optional<std::string> shape;       ///< --shape
    std::optional<std::string> array_name;  ///< --array
    std::optional<std::string> config_file; ///< --config
    std::optional<std::string> pcm;         ///< -D
    std::optional<double> duration_s;
    std::optional<double> speed_mm_s;
    std::optional<double> usual_speed_mm_s; ///< of strokes that say neither a time nor a speed
    bool fit = false;                       ///< --fit
    double fit_margin_mm = 0.0;
    std::optional<unsigned> rate;
    std::optional<unsigned> channels; ///< --channels
    std::optional<format_kind> format;
    std::optional<double> slope;
    std::optional<double> intercept_s;
    bool compensate = false;                          ///< --compensate low-speed
    observer_kind observer = observer_kind::centroid; ///< --observer
    low_speed_observer low_speed;                     ///< --sigma-mm and --sigma-v-mm-s
    plan_options plan;
    render_options render;
};

/// Whoever fills the settings: the command line, or a program.
class option_source {
public:
    option_source() = default;
    virtual ~option_source() = default;
    option_source(const option_source&) = delete;
    option_source& operator=(const option_source&) = delete;

    /// Returns whether the user gave the option of that name (that of the command line, without dashes).
    virtual bool given(const std::string& name) const = 0;
    /// Fills options that the user did not give from [defaults]. \throws error (bad_input).
    virtual void apply_defaults(const setup& says) = 0;
    /// \throws error (bad_input) where an option would plan `what` anew, which is planned already.
    virtual void refuse_planning(const std::string& what) const = 0;
    /// Settles options that depend on others, once all are known. \throws error (bad_input) for those that
    /// nothing uses.
    virtual void settle() = 0;
};

} // namespace tactor::session
