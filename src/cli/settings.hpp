// SPDX-License-Identifier: MIT
/// \file
/// The options of the command line that fill the settings.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "session/environment.hpp"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace tactor::cli {

using session::environment;
using session::settings;

/// The options of one command, in a form that the configuration's [defaults] can feed too.
class option_list : public session::option_source {
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

    void apply_defaults(const setup& says) override;
    void refuse_planning(const std::string& what) const override;
    void settle() override;

    /// Runs the command: what it throws about a value of [defaults] is said of its place there.
    int run(const std::function<int()>& act) const;

    bool given(const std::string& name) const override;
    /// Whether the command has an option of that name.
    bool has(const std::string& name) const;

private:
    using setter = std::function<void(const std::string&)>;
    /// --compensate, --sigma-mm and --sigma-v-mm-s.
    void add_compensation_options();
    /// Refuses options of the sound that nothing uses.
    void check_sound() const;
    /// Gives the scale of intensities the level that it needs.
    void settle_scale();
    CLI::Option* value(const std::string& names, const std::string& type, const std::string& help,
                       setter set);
    CLI::Option* flag(const std::string& name, const std::string& help, bool& into);

    CLI::App& command_;
    settings& settings_;
    std::map<std::string, std::pair<CLI::Option*, setter>> by_name_;
    std::map<std::string, source_place> from_files_; ///< options that [defaults] said
};

/// --format: one of `names`, of which the first is the default. `into` must live as long as the command.
void add_format_option(CLI::App& command, std::string& into, const std::vector<std::string>& names,
                       const std::string& help);

/// --force: output replaces a file that tactor did not write.
void add_force_option(CLI::App& command, bool& into);

} // namespace tactor::cli
