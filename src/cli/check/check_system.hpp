// SPDX-License-Identifier: MIT
/// \file
/// This machine as plain values, so that tests can check other machines.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tactor/alsa.hpp>
#include <tactor/tactor.hpp>

#include "cli/check/finding.hpp"

namespace tactor::cli {

/// A file in /dev that a group may open.
struct device_node {
    std::string path = {};
    std::string group = {};
    bool may_open = false;
};

struct system_facts {
    bool root = false; ///< this process may do all
    std::string user = {};
    std::vector<std::string> groups = {}; ///< groups in force
    std::vector<std::string> joined = {}; ///< groups of the user, in force or not
    realtime_rights rights = {};
    std::uint64_t memory_bytes = 0;         ///< memory that play would lock
    std::vector<device_node> sound = {};    ///< playback devices
    std::vector<device_node> gpio = {};     ///< chips
    std::vector<process_info> servers = {}; ///< running sound servers
    std::string keeps_outputs = {}; ///< file with the setting that lines keep their level when released
    bool releases_outputs = false;  ///< a file has the setting that they do not
    bool raspberry_pi = false;
};

/// Returns the name of the user that this process runs as; empty if it has none.
std::string own_user();

/// Returns the facts of this process and of files under `root`, "/" but in tests. Leaves out files that
/// cannot be read. Blocks shortly.
system_facts read_system(const std::filesystem::path& root = "/", const std::string& user = own_user());

/// Returns true if udev keeps desktop sound servers off a card.
bool servers_ignore(unsigned card_index, const std::filesystem::path& root = "/");

/// Needs of the set-up from the machine.
struct system_needs {
    std::string pcm = {};                   ///< name with which it is opened
    std::optional<card_info> card = {};     ///< card in its name
    std::vector<process_info> holders = {}; ///< programs that hold that card
    bool ignored = false;                   ///< udev keeps desktop sound servers off that card
    bool gpio = false;                      ///< [amplifier] or [sync] names a line
    bool amplifier = false;
    int priority = player_options{}.priority;
    bool require_realtime = false;
};

/// Checks rights, sound servers and lines.
std::vector<finding> check_system(const system_facts& f, const system_needs& n);

} // namespace tactor::cli
