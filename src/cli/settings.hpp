// SPDX-License-Identifier: MIT
/// \file
/// The command line of a command: its options and their values, their names in errors, and exit statuses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/tactor.hpp>

#include "options/option.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "session/environment.hpp"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace tactor::cli {

using session::environment;
using session::settings;

/// Exit statuses (see tactor(1)).
enum exit_status { status_ok = 0, status_failed = 1, status_usage = 2, status_device = 3 };

constexpr int exit_status_for(error_kind kind) noexcept
{
    return kind == error_kind::bad_input       ? status_usage
           : kind == error_kind::not_available ? status_device
                                               : status_failed;
}

struct command_line {
    CLI::App& app; ///< parser of the command; the options are added to it
    std::vector<std::string> words;
    std::function<void(const CLI::App&)> show = {}; ///< shows the options in place of running the command
    settings values = {};                           ///< values of the options of the table

    /// Parses the words, and prints the help if they ask for it. \throws error (bad_input); CLI::Success if
    /// the command has nothing to do.
    void parse() const;
};

/// Adds the options of the table that a command takes. `place` is the command's bit. Returns their values.
settings& add_options(command_line& line, std::uint64_t place);

/// Returns the first given option that only a playing stream can use, for sessions that play nothing. Empty
/// if there is none.
std::string asked_of_stream(const settings& s);

/// Adds the argument STROKE, which may be given `most` times, or has another name.
void add_strokes(command_line& line, int most = 1, const std::string& name = "STROKE");

/// Begins a heading of the help, with the options of the command that are added next.
void begin_group(CLI::App& command, const std::string& heading = "Options");

/// Adds --format, with one of `names`; the first is the default. `into` must live as long as the command.
void add_format_option(CLI::App& command, std::string& into, const std::vector<std::string>& names,
                       const std::string& help);

/// Adds --force, which lets output replace a file that tactor did not write or that changed since.
void add_force_option(CLI::App& command, bool& into);

/// Adds an option whose text `take` reads. Returns it.
CLI::Option* add_text(CLI::App& command, const std::string& names, const std::string& type,
                      const std::string& help, const std::function<void(const std::string&)>& take);

/// Returns the index of a text in a list of names. \throws error (bad_input), which lists them.
std::size_t choose(std::string_view option, const std::string& text, const std::vector<std::string>& names);

/// Throws error (bad_input) about an option.
[[noreturn]] void refuse_option(std::string_view option, const std::string& why, std::string_view hint);

/// Options of every picture.
struct picture_options {
    std::string file = {}; ///< empty: none
    double width_mm = plot::figure_options{}.width_mm;
    unsigned dpi = plot::usual_dpi;
    bool force = false;     ///< also replaces a file that tactor did not write, or that was changed
    std::string title = {}; ///< --title; empty: the picture's own, "none": none

    bool has_title() const { return title != "none"; }
    /// Returns the title of --title, or else `own`.
    std::string choose_title(const std::string& own) const { return title.empty() ? own : title; }
};

/// Adds --width, --dpi, --title and --force. `usual_width`: the default width, for the help.
void add_picture_options(CLI::App& command, picture_options& into, const std::string& usual_width);

/// Returns "--level-dbfs" for the row level_dbfs.
std::string option_name(const options::option& o);

/// Returns the text with its marks as options: "--timing fit".
std::string spelled(std::string_view marked);

/// Returns an error that names options in place of fields and marks, also in its hint: "--soa" for "soa_s",
/// "--timing fit" for "timing = fit". A second call changes nothing.
error in_options(const error& e);

/// Runs a command, as the others below do. Returns the exit status. \throws error; CLI::Success.
int run_plan(command_line& line);
int run_analyze(command_line& line);
int run_compare(command_line& line);
int run_experiment(command_line& line);
int run_report(command_line& line);
int run_render(command_line& line);
int run_play(command_line& line);
int run_plot(command_line& line);
int run_convert(command_line& line);
int run_devices(command_line& line);
int run_calibrate(command_line& line);
int run_check(command_line& line);
int run_off(command_line& line);
int run_serve(command_line& line);
int run_status(command_line& line);
int run_stop(command_line& line);

} // namespace tactor::cli
