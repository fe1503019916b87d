// SPDX-License-Identifier: MIT
#include "net/listen.hpp"

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

#include "core/split.hpp"

namespace tactor::net {
namespace {

namespace fs = std::filesystem;

// Adds the names of these sockets as links in /proc/PID/fd show them.
void add_sockets(const std::string& table, const std::string& port, bool stream, std::set<std::string>& to)
{
    constexpr const char* listens = "0A";
    std::ifstream file("/proc/net/" + table);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::istringstream in(line);
        std::string number, local, remote, state, queues, timer, retries, user, timeout, inode;
        in >> number >> local >> remote >> state >> queues >> timer >> retries >> user >> timeout >> inode;
        if (local.ends_with(port) && (!stream || state == listens))
            to.insert("socket:[" + inode + "]");
    }
}

bool holds(const fs::path& process, const std::set<std::string>& sockets)
{
    std::error_code failed;
    for (fs::directory_iterator at(process / "fd", failed), end; !failed && at != end; at.increment(failed)) {
        std::error_code gone;
        if (sockets.contains(fs::read_symlink(at->path(), gone).string()))
            return true;
    }
    return false;
}

} // namespace

std::string process_name(pid_t pid)
{
    std::string name;
    std::getline(std::ifstream(fmt::format("/proc/{}/comm", pid)), name);
    return name.empty() ? fmt::format("process {}", pid) : fmt::format("{}, process {}", name, pid);
}

std::string find_port_holder(std::uint16_t port, bool stream)
{
    std::set<std::string> sockets;
    for (const char* version : {"", "6"})
        add_sockets(fmt::format("{}{}", stream ? "tcp" : "udp", version), fmt::format(":{:04X}", port),
                    stream, sockets);
    if (sockets.empty())
        return {};
    std::error_code failed;
    for (fs::directory_iterator at("/proc", failed), end; !failed && at != end; at.increment(failed)) {
        const std::string name = at->path().filename().string();
        if (const auto pid = detail::number_in<pid_t>(name); pid && holds(at->path(), sockets))
            return process_name(*pid);
    }
    return "another user's process";
}

} // namespace tactor::net
