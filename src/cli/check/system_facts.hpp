// SPDX-License-Identifier: MIT
/// \file
/// What this machine is like, as plain values, so that it can be judged without being it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/check/listeners.hpp"

namespace tactor::cli {

/// A file in /dev that a group may open.
struct device_node {
    std::string path = {};
    std::string group = {};
    bool may_open = false;
};

/// How soon the kernel lets a real-time thread run.
enum class preemption { unknown, none, voluntary, full, realtime };

/// What the process is, whatever the files say.
struct own_facts {
    bool root = false;
    std::string user = {};
    std::vector<std::string> groups = {}; ///< in force
    realtime_rights rights = {};
    std::uint64_t memory_bytes = 0; ///< that play would lock
    std::string kernel = {};        ///< version text, as uname -v
};

struct system_facts {
    own_facts own;
    std::vector<std::string> joined = {}; ///< groups that the user is a member of, in force or not
    std::vector<device_node> sound = {};  ///< playback devices
    std::vector<device_node> gpio = {};   ///< chips
    preemption preempts = preemption::unknown;
    std::vector<std::string> governors = {};      ///< of the CPUs, each once; none: no frequency scaling
    std::vector<process_info> servers = {};       ///< sound servers that run
    std::vector<listening_service> services = {}; ///< `tactor serve` that runs
    std::optional<std::string> keeps_outputs =
        {};                        ///< file that says that lines keep their level when released
    bool releases_outputs = false; ///< a file says that they do not
    bool raspberry_pi = false;
    std::vector<std::string> off_units = {}; ///< systemd's, that run "tactor off" when they have stopped
};

own_facts read_own();

/// From files under `root`, "/" but in tests. What cannot be read is left out. Blocks shortly.
system_facts read_system(own_facts own, const std::filesystem::path& root = "/");

/// Whether udev keeps desktop sound servers off a card.
bool servers_ignore(unsigned card_index, const std::filesystem::path& root = "/");

} // namespace tactor::cli
