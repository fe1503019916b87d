// SPDX-License-Identifier: MIT
/// \file
/// What the command line and the configuration ask for, and the options that say it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace tactor::cli {

/// Everything that one command was asked for. Options not given hold the built-in default.
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

/// The options of one command, in a form that the configuration's [defaults] can feed too.
class option_list {
public:
    option_list(CLI::App& command, settings& into);

    /// STROKE, --path, array and how it is planned.
    void add_stroke_options();
    /// --array and --config: what commands without a stroke need.
    void add_array_options();
    /// --algorithm, --soa, --slope and --intercept.
    void add_timing_options();
    /// --observer.
    void add_observer_options();
    /// What vibrates: --waveform, --am and what belongs to them.
    void add_waveform_options();
    /// --envelope, --attack and --release.
    void add_envelope_options();
    /// --intensity-scale and --stevens-exponent.
    void add_scale_options();
    /// --carrier alone.
    void add_carrier_option();
    /// Carrier, levels and rate.
    void add_sound_options();
    /// --rate and --sample-format alone.
    void add_rate_options();
    /// --channels.
    void add_channels_option();
    /// -D and --channels.
    void add_device_options(const char* otherwise = "else null");

    /// Fills options that the command line does not give from what [defaults] says.
    /// \throws error (bad_input).
    void apply_defaults(const setup& says);

    /// Runs the command: what it throws about a value of [defaults] is said of its place there.
    int run(const std::function<int()>& act) const;

    /// Whether the command line gives an option of that name (without dashes).
    bool given(const std::string& name) const;
    /// Whether the command has an option of that name.
    bool has(const std::string& name) const;

private:
    using setter = std::function<void(const std::string&)>;
    /// --compensate, --sigma-mm and --sigma-v-mm-s.
    void add_compensation_options();
    CLI::Option* value(const std::string& names, const std::string& type, const std::string& help,
                       setter set);
    CLI::Option* flag(const std::string& name, const std::string& help, bool& into);

    CLI::App& command_;
    settings& settings_;
    std::map<std::string, std::pair<CLI::Option*, setter>> by_name_;
    std::map<std::string, source_place> from_files_; ///< options that [defaults] said
};

/// What the scale of intensities needs of the level. \throws error (bad_input).
void settle_scale(settings& s, const option_list& options);

/// Refuses options of the sound that nothing uses. \throws error (bad_input).
void check_sound(const settings& s, const option_list& options);

/// --format: one of `names`, of which the first is the default. `into` must live as long as the command.
void add_format_option(CLI::App& command, std::string& into, const std::vector<std::string>& names,
                       const std::string& help);

/// --force: output replaces a file that tactor did not write.
void add_force_option(CLI::App& command, bool& into);

} // namespace tactor::cli
