// SPDX-License-Identifier: MIT
/// \file
/// Options of tactor experiment, and its option --dry-run (dry_run.cpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "cli/session/page_options.hpp"
#include "cli/settings.hpp"
#include "core/members.hpp"
#include "study/analysis/power.hpp"
#include "study/experiment/simulated.hpp"
#include "study/session/experiment_session.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

struct experiment_options {
    study::session_request session; ///< `who` and `all_sessions` are derived from other options
    std::string folder = {};        ///< folder of the study; with --part, a file
    std::string format = "text";    ///< format for --dry-run and --power
    bool resume = false;
    bool new_session = false; ///< with `resume`: only if there is no session
    bool print = false;
    bool dry_run = false;
    bool check_noise = false;
    bool allow_sound_server = false;
    page_options page = {};                ///< where the participant sees the questions
    std::vector<std::string> keypads = {}; ///< input devices of the participant
    std::string masker = {};               ///< PCM device of the masking noise; empty if none
    std::optional<study::simulation> simulate = {};
    std::vector<std::size_t> power = {}; ///< numbers of participants for --power; empty without --power
    std::size_t studies = study::power_request{}.studies;
    std::size_t part = 1;                ///< number of the part for --power, from 1
    std::size_t parts = 0;               ///< number of parts; 0 for a single run
    std::vector<std::string> merge = {}; ///< files of all parts; empty without --merge
};

/// Adds the options of the command. `o` must outlive the command.
void add_experiment_options(CLI::App& command, experiment_options& o);

/// Checks that no options exclude each other and that no required option is missing. \throws error
/// (bad_input).
void check_experiment_options(const settings& s, const experiment_options& o);

void print_dry_run_text(const study::prepared_experiment& p);
void print_dry_run_json(const study::prepared_experiment& p);

/// Returns the JSON Schema tactor-experiment/1 of a dry run.
nlohmann::ordered_json dry_run_schema();

/// The experiment that a JSON object describes.
struct experiment_name {
    std::string name = {};
    std::string title = {};
    std::string sha256 = {};
};

experiment_name make_experiment_name(const study::experiment_definition& d);

template <class Io, detail::either<experiment_name> Name>
void members(Io& io, Name& v)
{
    constexpr detail::about what{"name, title, and SHA-256 of the definition's text"};
    io("name", v.name, what);
    io("title", v.title, what);
    io("sha256", v.sha256, what);
}

} // namespace tactor::cli
