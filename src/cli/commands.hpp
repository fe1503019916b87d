// SPDX-License-Identifier: MIT
/// \file
/// The commands: each adds itself to the command line and leaves what runs it.
#pragma once

#include <functional>

#include <tactor/error.hpp>

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

/// Runs after the command line was parsed; returns the exit status, throws tactor::error.
using command = std::function<int()>;

command add_plan(CLI::App& app);
command add_analyze(CLI::App& app);
command add_compare(CLI::App& app);
command add_experiment(CLI::App& app);
command add_report(CLI::App& app);
command add_render(CLI::App& app);
command add_play(CLI::App& app);
command add_plot(CLI::App& app);
command add_devices(CLI::App& app);
command add_calibrate(CLI::App& app);
command add_check(CLI::App& app);
command add_off(CLI::App& app);
command add_serve(CLI::App& app);
command add_status(CLI::App& app);
command add_stop(CLI::App& app);

} // namespace tactor::cli
