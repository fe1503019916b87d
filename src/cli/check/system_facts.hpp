// SPDX-License-Identifier: MIT
/// \file
/// This machine as plain values, so that it can be judged without being it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/alsa.hpp>
#include <tactor/tactor.hpp>

#include "cli/check/finding.hpp"

namespace tactor::cli {

/// An endpoint: a socket's path, "127.0.0.1:4001", or "osc 127.0.0.1:4002".
struct endpoint {
    std::string at = {};
    bool beyond_loopback = false;
};

/// A process `tactor serve`.
struct listening_service {
    process_info who = {};
    bool may_look = true; ///< its descriptors may be read: only its user's and root's may
    std::vector<endpoint> endpoints = {};
};

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

/// An address as /proc/net/tcp (8 digits) and tcp6 (32) have it, "0100007F:0FA1" with the port; nothing there
/// (an empty `at`) for what is none.
endpoint endpoint_of(std::string_view hexadecimal);

/// By process number, from files under `root`/proc. What cannot be read is left out. Blocks shortly.
std::vector<listening_service> find_services(const std::filesystem::path& root);

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

/// In order of name; none for a folder that cannot be read.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

/// Without the end of the last line; /proc also ends texts with zeros. Empty where it cannot be read.
std::string text_of(const std::filesystem::path& file);

struct process_folder {
    int pid = 0;
    std::filesystem::path path = {};
};

/// `root`/proc/NUMBER, by number.
std::vector<process_folder> processes(const std::filesystem::path& root);

} // namespace tactor::cli
