// SPDX-License-Identifier: MIT
/// \file
/// Rights, limits, kernel and sound servers, judged from facts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/check/finding.hpp"
#include "cli/check/system_facts.hpp"

namespace tactor::cli {

/// What the set-up needs of the machine.
struct system_needs {
    std::string pcm = {};                   ///< as it will be opened
    std::optional<card_info> card = {};     ///< that its name says
    std::vector<process_info> holders = {}; ///< of that card
    bool ignored = false;                   ///< udev keeps desktop sound servers off that card
    bool gpio = false;                      ///< [amplifier] or [sync] names a line
    bool amplifier = false;
    int priority = player_options{}.priority;
    bool require_realtime = false;
};

std::vector<finding> check_system(const system_facts& f, const system_needs& n);

} // namespace tactor::cli
