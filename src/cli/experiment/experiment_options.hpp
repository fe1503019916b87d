// SPDX-License-Identifier: MIT
/// \file
/// What tactor experiment is asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/session/page_options.hpp"
#include "cli/settings.hpp"
#include "study/experiment/simulated.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

struct experiment_options {
    std::string definition; ///< a name that is built in, or a file
    std::string participant = {};
    std::string folder = {};
    std::string format = "text"; ///< of --dry-run and --power
    bool resume = false;
    bool print = false;
    bool dry_run = false;
    bool check_noise = false;
    bool allow_sound_server = false;
    page_options page = {};                ///< what the participant sees
    std::vector<std::string> keypads = {}; ///< input devices of the participant's
    std::string masker = {};               ///< PCM of the masking noise; empty: none
    std::optional<std::uint64_t> seed = {};
    std::optional<study::simulation> simulate = {};
};

/// `o` must live as long as the command.
void add_experiment_options(CLI::App& command, experiment_options& o);

/// What goes together and what is missing. \throws error (bad_input).
void check_experiment_options(const settings& s, const experiment_options& o);

} // namespace tactor::cli
