// SPDX-License-Identifier: MIT
/// \file
/// The commands: each adds its options to the command line, parses it, and runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <tactor/error.hpp>

#include "session/environment.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

/// Exit statuses (see tactor(1)).
enum exit_status { status_ok = 0, status_failed = 1, status_usage = 2, status_device = 3 };

/// Returns the exit status for an error.
constexpr int exit_status_for(error_kind kind) noexcept
{
    return kind == error_kind::bad_input       ? status_usage
           : kind == error_kind::not_available ? status_device
                                               : status_failed;
}

/// The command line of a command.
struct command_line {
    CLI::App& app; ///< of the command: takes its options
    std::vector<std::string> words;
    std::function<void(const CLI::App&)> show = {}; ///< shows the options in place of running the command
    session::settings values = {};                  ///< values of the options of the table

    /// Parses the words, and prints the help if they ask for it. \throws error (bad_input); CLI::Success if
    /// the command has nothing to do.
    void parse() const;
};

/// Each returns the exit status. \throws error; CLI::Success.
int run_plan(command_line& line);
int run_analyze(command_line& line);
int run_compare(command_line& line);
int run_experiment(command_line& line);
int run_report(command_line& line);
int run_render(command_line& line);
int run_play(command_line& line);
int run_plot(command_line& line);
int run_devices(command_line& line);
int run_calibrate(command_line& line);
int run_check(command_line& line);
int run_off(command_line& line);
int run_serve(command_line& line);
int run_status(command_line& line);
int run_stop(command_line& line);

} // namespace tactor::cli
