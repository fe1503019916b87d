// SPDX-License-Identifier: MIT
/// \file
/// The command line of a command: options, their values and their names in errors. Also the exit statuses.
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

constexpr int find_exit_status(error_kind kind) noexcept
{
    return kind == error_kind::bad_input       ? status_usage
           : kind == error_kind::not_available ? status_device
                                               : status_failed;
}

struct command_line {
    CLI::App& app; ///< parser of the command, to which options are added
    std::vector<std::string> words;
    std::function<void(const CLI::App&)> show = {}; ///< shows the options instead of running the command
    settings values = {};                           ///< values of the options in the table

    /// Parses the words. Prints the help if they request it.
    /// \throws error (bad_input); CLI::Success if the command has nothing more to do.
    void parse() const;
};

/// Adds the options in the table that apply to a command. `place` is the bit of the command. Returns the
/// values of the options.
settings& add_options(command_line& line, std::uint64_t place);

/// Returns the first option on the command line that only a playing stream uses, or "" if there is none. For
/// sessions that play nothing.
std::string find_stream_option(const settings& s);

/// Adds the argument STROKE, or an argument with another name, which may occur up to `most` times.
void add_stroke_argument(command_line& line, int most = 1, const std::string& name = "STROKE");

/// Starts a group of options. The help shows the options that are added next under `heading`.
void begin_group(CLI::App& command, const std::string& heading = "Options");

/// Adds --format. The value is one of `names`, and the first name is the default. `into` must outlive the
/// command.
void add_format_option(CLI::App& command, std::string& into, const std::vector<std::string>& names,
                       const std::string& help);

/// Adds --force. With this option, output may replace a file that tactor did not write, or that has been
/// changed.
void add_force_option(CLI::App& command, bool& into);

/// Adds an option, and returns it. `take` parses the text of its value.
CLI::Option* add_text_option(CLI::App& command, const std::string& names, const std::string& type,
                             const std::string& help, const std::function<void(const std::string&)>& take);

/// Returns the index of a text in a list of names. \throws error (bad_input) that lists the names.
std::size_t choose(std::string_view option, const std::string& text, const std::vector<std::string>& names);

/// Throws error (bad_input) about an option.
[[noreturn]] void refuse_option(std::string_view option, const std::string& why, std::string_view hint);

/// Options that all commands with pictures have.
struct picture_options {
    std::string file = {}; ///< name of the file; empty if none
    double width_mm = plot::figure_options{}.width_mm;
    unsigned dpi = plot::usual_dpi;
    bool force = false;     ///< allows replacing files that tactor did not write, or that were changed
    std::string title = {}; ///< --title; empty for the default title, "none" for no title

    bool has_title() const { return title != "none"; }
    /// Returns the value of --title, or `own` if --title is not set.
    std::string choose_title(const std::string& own) const { return title.empty() ? own : title; }
};

/// Adds --width, --dpi, --title and --force. `usual_width` is the default width in the help.
void add_picture_options(CLI::App& command, picture_options& into, const std::string& usual_width);

/// Returns the option's name on the command line, such as "--level-dbfs" for the row level_dbfs.
std::string option_name(const options::option& o);

/// Returns a text with its marks replaced by options, such as "--timing fit".
std::string spell_marks(std::string_view marked);

/// Returns an error in which fields and marks are replaced by options, also in its hint: "--soa" for "soa_s",
/// "--timing fit" for "timing = fit". Calling it again changes nothing.
error reword_as_options(const error& e);

/// Runs a command. Returns the exit status. The functions below do the same for other commands. \throws
/// error; CLI::Success.
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
