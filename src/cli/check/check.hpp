// SPDX-License-Identifier: MIT
/// \file
/// Findings of `check`, their output, the checks of array, lines and machine, and the walk. The machine is a
/// plain value, so that tests can check others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/tactor.hpp>

#include "cli/settings.hpp"
#include "session/play_session.hpp"
#include "session/walk.hpp"

namespace tactor::cli {

enum class level { ok, warning, error };

struct finding {
    std::string check; ///< name of the check
    level how = level::ok;
    std::string found;
    std::string cure = {};                 ///< what to do; empty: nothing
    error_kind kind = error_kind::runtime; ///< kind of an error, for the exit status
};

inline finding passed(std::string check, std::string found, std::string cure = {})
{
    return {std::move(check), level::ok, std::move(found), std::move(cure)};
}

inline finding warning(std::string check, std::string found, std::string cure)
{
    return {std::move(check), level::warning, std::move(found), std::move(cure)};
}

inline finding failure(std::string check, const error& of_library)
{
    const error e = in_options(of_library);
    std::string why =
        e.subject() == check ? std::string(e.why()) : std::string(e.subject()) + ": " + std::string(e.why());
    return {std::move(check), level::error, std::move(why), std::string(e.hint()), e.kind()};
}

std::string_view to_string(level l);

/// Returns the exit status: that of bad input, else that of a device error, else that of any other error,
/// else 0.
int worst_status(const std::vector<finding>& all);

/// Outcome of a walk with answers.
struct walk_outcome {
    const array& tactors;
    const session::walk_answers& felt;
    const session::walk_map& verdict;
};

/// Returns the findings as text for people. `brief`: leaves out the good ones, because a walk follows.
std::string check_text(const std::vector<finding>& all, bool brief);

/// Returns an object of schema tactor-check/1.
std::string check_json(const std::vector<finding>& all, const std::optional<walk_outcome>& walked);
/// Returns the schema tactor-check/1.
nlohmann::ordered_json check_schema();

using line_finder = gpio_line_place (*)(const gpio_line_name&);

/// Checks that each GPIO line exists and is free. If people feel the array (`felt`), checks that its
/// amplifier has a line. Requests and drives none. `find`: find_gpio_line(), except in tests.
std::vector<finding> check_lines(const setup& config, bool felt, line_finder find = find_gpio_line);

/// Checks places, channels, levels, actuators, bursts and limits. Looks at values only.
std::vector<finding> check_array(const settings& s, const environment& e);

/// Checks actuators against burst length and carrier, as a part of check_array(). `rate`: Hz.
std::vector<finding> check_bursts(const plan_options& p, const array& a, unsigned rate);

/// A file in /dev that a group may open.
struct device_node {
    std::string path = {};
    std::string group = {};
    bool may_open = false;
};

struct system_facts {
    bool root = false; ///< this process has all rights
    std::string user = {};
    std::vector<std::string> groups = {}; ///< groups in force
    std::vector<std::string> joined = {}; ///< groups of the user, in force or not
    realtime_rights rights = {};
    int priority_error = 0;                 ///< errno of an attempt to get the audio thread's priority
    int priority = 0;                       ///< priority of that attempt; 0: refused
    std::uint64_t memory_bytes = 0;         ///< memory that play would lock
    std::vector<device_node> sound = {};    ///< playback devices
    std::vector<device_node> gpio = {};     ///< chips
    std::vector<process_info> servers = {}; ///< running sound servers
    std::string keeps_outputs = {};         ///< file that lets lines keep their level when released
    bool releases_outputs = false;          ///< a file has the opposite setting
    bool raspberry_pi = false;
};

/// Returns the name of the user that this process runs as; empty if it has none.
std::string own_user();

/// Returns the facts of this process and of files under `root`, which is "/" except in tests. Leaves out
/// files that cannot be read. Blocks for a short time.
system_facts read_system(const std::filesystem::path& root = "/", const std::string& user = own_user());

/// Returns true if udev keeps desktop sound servers off a card.
bool servers_ignore(unsigned card_index, const std::filesystem::path& root = "/");

/// Needs of the set-up from the machine.
struct system_needs {
    std::string pcm = {};                   ///< name under which it is opened
    std::optional<card_info> card = {};     ///< card in its name
    std::vector<process_info> holders = {}; ///< programs that hold that card
    bool ignored = false;                   ///< udev keeps desktop sound servers off that card
    bool gpio = false;                      ///< [amplifier] or [sync] names a line
    bool amplifier = false;
    bool require_realtime = false;
};

/// Checks rights, sound servers and lines.
std::vector<finding> check_system(const system_facts& f, const system_needs& n);

struct check_options {
    std::string format = "text";
    bool walk = false;
    bool no_questions = false;           ///< a walk only names each tactor
    std::string output = {};             ///< empty: none
    std::optional<double> max_dbfs = {}; ///< limit of all tactors, for the walk and the file

    bool json() const { return format == "json"; }
};

struct walk_result {
    int signal = 0; ///< signal that ended the walk, or 0
    session::walk_answers felt;
};

/// Drives each tactor and asks where it was felt, on standard input. Questions go to standard output, or to
/// standard error if that is JSON.
/// \throws error: errors of play; runtime when the walk is left before its end, or a tactor was interrupted
///         and not driven again.
walk_result walk(const alsa_options& device, const settings& s, const environment& e,
                 const render_options& render, const check_options& o,
                 const session::stream_source& source = {});

} // namespace tactor::cli
