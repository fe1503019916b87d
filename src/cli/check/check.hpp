// SPDX-License-Identifier: MIT
/// \file
/// Findings of `check` and their output; checks of array, lines and machine; and the walk. The facts about
/// the machine are a plain value, so that tests can check imaginary machines.
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
    std::string cure = {};                 ///< what the user should do; empty if nothing
    error_kind kind = error_kind::runtime; ///< kind of error, which determines the exit status
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
    const error e = reword_as_options(of_library);
    std::string why =
        e.subject() == check ? std::string(e.why()) : std::string(e.subject()) + ": " + std::string(e.why());
    return {std::move(check), level::error, std::move(why), std::string(e.hint()), e.kind()};
}

std::string_view to_string(level l);

/// Returns the exit status. Bad input has priority over a device error, and a device error over any other
/// error. Returns 0 if there is no error.
int worst_status(const std::vector<finding>& all);

/// Result of a walk in which the questions were answered.
struct walk_outcome {
    const array& tactors;
    const session::walk_answers& felt;
    const session::walk_map& verdict;
};

/// Returns the findings as text. If `brief` is true, leaves out the good findings, because a walk follows.
std::string check_text(const std::vector<finding>& all, bool brief);

/// Returns the findings as a JSON object of schema tactor-check/1.
std::string check_json(const std::vector<finding>& all, const std::optional<walk_outcome>& walked);
/// Returns the JSON Schema tactor-check/1.
nlohmann::ordered_json check_schema();

using line_finder = gpio_line_place (*)(const gpio_line_name&);

/// Checks that each GPIO line exists and is free. If `felt` is true, people feel the array, so also checks
/// that its amplifier has a line. Does not request or drive lines. `find` is find_gpio_line() except in
/// tests.
std::vector<finding> check_lines(const setup& config, bool felt, line_finder find = find_gpio_line);

/// Checks places, channels, levels, actuators, bursts and limits. Checks values only, without a device.
std::vector<finding> check_array(const settings& s, const environment& e);

/// Checks whether the actuators suit the burst duration and the carrier. Part of check_array(). `rate` is in
/// Hz.
std::vector<finding> check_bursts(const plan_options& p, const array& a, unsigned rate);

/// A file in /dev that members of a group may open.
struct device_node {
    std::string path = {};
    std::string group = {};
    bool may_open = false;
};

struct system_facts {
    bool root = false; ///< true if this process may do everything
    std::string user = {};
    std::vector<std::string> groups = {}; ///< groups of this process
    std::vector<std::string> joined = {}; ///< groups of the user, even if they are not in effect yet
    realtime_rights rights = {};
    int priority_error = 0;                 ///< errno of an attempt to get real-time priority; 0: no error
    int priority = 0;                       ///< real-time priority of this attempt; 0 if refused
    std::uint64_t memory_bytes = 0;         ///< memory that `play` would lock
    std::vector<device_node> sound = {};    ///< playback devices
    std::vector<device_node> gpio = {};     ///< GPIO chips
    std::vector<process_info> servers = {}; ///< sound servers that are running
    std::string keeps_outputs = {};         ///< file that lets lines keep their levels when released
    bool releases_outputs = false;          ///< true if a file has the opposite setting
    bool raspberry_pi = false;
};

/// Returns the name of the user of this process, or "" if the user has no name.
std::string own_user();

/// Returns facts about this process, and about files under `root`, which is "/" except in tests. Ignores
/// files that cannot be read. Blocks for a short time.
system_facts read_system(const std::filesystem::path& root = "/", const std::string& user = own_user());

/// Returns true if a udev rule keeps desktop sound servers away from a card.
bool is_ignored_by_servers(unsigned card_index, const std::filesystem::path& root = "/");

/// Requirements of the set-up on the machine.
struct system_needs {
    std::string pcm = {};                   ///< name with which the PCM device is opened
    std::optional<card_info> card = {};     ///< card in the name of the PCM device
    std::vector<process_info> holders = {}; ///< programs that use this card
    bool ignored = false;                   ///< true if udev keeps sound servers away from this card
    bool gpio = false;                      ///< true if [amplifier] or [sync] names a line
    bool amplifier = false;
    bool require_realtime = false;
};

/// Checks permissions, sound servers and lines.
std::vector<finding> check_system(const system_facts& f, const system_needs& n);

struct check_options {
    std::string format = "text";
    bool walk = false;
    bool no_questions = false;           ///< if true, the walk only names each tactor
    std::string output = {};             ///< empty if no file is written
    std::optional<double> max_dbfs = {}; ///< limit of all tactors, in the walk and in the file

    bool json() const { return format == "json"; }
};

struct walk_result {
    int signal = 0; ///< signal that ended the walk; 0 if none
    session::walk_answers felt;
};

/// Drives one tactor after the other, and asks the user where each was felt. Reads the answers from standard
/// input. Writes the questions to standard output, or to standard error if standard output is JSON.
/// \throws the errors of play; error (runtime) if the user ended the walk early, or if a tactor was
///         interrupted and not driven again.
walk_result walk(const alsa_options& device, const settings& s, const environment& e,
                 const render_options& render, const check_options& o,
                 const session::stream_source& source = {});

} // namespace tactor::cli
