// SPDX-License-Identifier: MIT
/// \file
/// This machine as plain values, so that tests can check other machines.
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
    bool may_look = true; ///< its descriptors can be read, by its user and root only
    std::vector<endpoint> endpoints = {};
};

/// A file in /dev that a group may open.
struct device_node {
    std::string path = {};
    std::string group = {};
    bool may_open = false;
};

/// Preemption of the kernel, which delays a real-time thread.
enum class preemption { unknown, none, voluntary, full, realtime };

/// Facts of this process, which no file under `root` has.
struct own_facts {
    bool root = false;
    std::string user = {};
    std::vector<std::string> groups = {}; ///< groups in force
    realtime_rights rights = {};
    std::uint64_t memory_bytes = 0; ///< memory that play would lock
    std::string kernel = {};        ///< version text, as uname -v
};

struct system_facts {
    own_facts own;
    std::vector<std::string> joined = {}; ///< groups of the user, in force or not
    std::vector<device_node> sound = {};  ///< playback devices
    std::vector<device_node> gpio = {};   ///< chips
    preemption preempts = preemption::unknown;
    std::vector<std::string> governors = {};      ///< of the CPUs, each once; none: no frequency scaling
    std::vector<process_info> servers = {};       ///< running sound servers
    std::vector<listening_service> services = {}; ///< running `tactor serve`
    std::optional<std::string> keeps_outputs =
        {};                        ///< file with the setting that lines keep their level when released
    bool releases_outputs = false; ///< a file has the setting that they do not
    bool raspberry_pi = false;
    std::vector<std::string> off_units = {}; ///< units of systemd that run "tactor off" when they stop
};

/// Returns the facts of this process.
own_facts read_own();

/// Reads files under `root`, "/" but in tests. Leaves out files that cannot be read. Blocks shortly.
system_facts read_system(own_facts own, const std::filesystem::path& root = "/");

/// Returns true if udev keeps desktop sound servers off a card.
bool servers_ignore(unsigned card_index, const std::filesystem::path& root = "/");

/// Parses an address with its port as in /proc/net/tcp (8 digits) and tcp6 (32), "0100007F:0FA1". Returns an
/// empty `at` for other texts.
endpoint parse_endpoint(std::string_view hexadecimal);

/// Returns running services by process number, from files under `root`/proc. Leaves out files that cannot be
/// read. Blocks shortly.
std::vector<listening_service> find_services(const std::filesystem::path& root);

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

/// Checks rights, servers, services, lines and the kernel.
std::vector<finding> check_system(const system_facts& f, const system_needs& n);

/// Returns the entries of a folder by name; none if it cannot be read.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

/// Returns the text of a file without the end of the last line, and without the zeros with which /proc ends
/// texts; empty if it cannot be read.
std::string read_trimmed(const std::filesystem::path& file);

struct process_folder {
    int pid = 0;
    std::filesystem::path path = {};
};

/// Returns the folders `root`/proc/NUMBER, by number.
std::vector<process_folder> processes(const std::filesystem::path& root);

} // namespace tactor::cli
