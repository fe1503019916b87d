// SPDX-License-Identifier: MIT
#include "cli/check/system_facts.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <system_error>

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "core/split.hpp"
#include "session/own_memory.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

// Returns the entries of a folder by name; none if it cannot be read.
std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    std::error_code gone;
    for (fs::directory_iterator i(folder, gone), end; !gone && i != end; i.increment(gone))
        all.push_back(i->path());
    std::sort(all.begin(), all.end());
    return all;
}

// Returns the text of a file without the end of the last line, and without the zeros with which /proc ends
// texts; empty if it cannot be read. Reads by operator<<, which does not throw if the process ends meanwhile.
std::string read_trimmed(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    std::string s = text.str();
    while (!s.empty() && (s.back() == '\n' || s.back() == '\0'))
        s.pop_back();
    return s;
}

std::string group_name(gid_t id)
{
    const group* g = ::getgrgid(id);
    return g != nullptr ? g->gr_name : fmt::format("{}", id);
}

std::vector<device_node> nodes(const fs::path& folder, bool (*wanted)(const std::string&))
{
    std::vector<device_node> all;
    for (const fs::path& f : entries(folder)) {
        struct stat s {};
        if (wanted(f.filename().string()) && ::stat(f.c_str(), &s) == 0)
            all.push_back({f.string(), group_name(s.st_gid), ::access(f.c_str(), R_OK | W_OK) == 0});
    }
    return all;
}

// Returns the groups of a user, from lines "name:x:29:ann,bob".
std::vector<std::string> find_groups(const std::string& user, const fs::path& file)
{
    std::vector<std::string> all;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        const std::string members = fmt::format(",{},", line.substr(line.rfind(':') + 1));
        if (!user.empty() && members.find(fmt::format(",{},", user)) != std::string::npos)
            all.push_back(line.substr(0, line.find(':')));
    }
    return all;
}

bool has(const std::string& text, const char* part)
{
    return text.find(part) != std::string::npos;
}

std::vector<process_info> find_sound_servers(const fs::path& root)
{
    constexpr std::array known{"pulseaudio",  "pipewire", "pipewire-pulse",
                               "wireplumber", "jackd",    "jackdbus"};
    std::vector<process_info> all;
    for (const fs::path& process : entries(root / "proc")) {
        const auto pid = detail::number_in<int>(process.filename().string());
        const std::string program = pid ? read_trimmed(process / "comm") : "";
        if (std::find(known.begin(), known.end(), program) != known.end())
            all.push_back({*pid, program});
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.pid < b.pid; });
    return all;
}

bool is_playback(const std::string& name)
{
    return name.starts_with("pcmC") && name.ends_with('p');
}

bool is_chip(const std::string& name)
{
    return name.starts_with("gpiochip");
}

} // namespace

own_facts read_own()
{
    own_facts f;
    f.root = ::geteuid() == 0;
    if (const passwd* p = ::getpwuid(::geteuid()))
        f.user = p->pw_name;
    std::vector<gid_t> ids(static_cast<std::size_t>(std::max(0, ::getgroups(0, nullptr))));
    ids.resize(static_cast<std::size_t>(std::max(0, ::getgroups(static_cast<int>(ids.size()), ids.data()))));
    ids.push_back(::getegid());
    for (const gid_t id : ids)
        f.groups.push_back(group_name(id));
    f.rights = probe_realtime_rights();
    f.memory_bytes = session::memory_to_lock();
    return f;
}

system_facts read_system(own_facts own, const fs::path& root)
{
    system_facts f;
    f.joined = find_groups(own.user, root / "etc/group");
    f.sound = nodes(root / "dev/snd", is_playback);
    f.gpio = nodes(root / "dev", is_chip);
    f.servers = find_sound_servers(root);
    for (const fs::path& module : entries(root / "sys/module")) {
        const fs::path file = module / "parameters/persist_gpio_outputs";
        const std::string value = read_trimmed(file);
        if (value == "Y" || value == "1")
            f.keeps_outputs = file.string();
        else if (!value.empty())
            f.releases_outputs = true;
    }
    f.raspberry_pi = has(read_trimmed(root / "proc/device-tree/model"), "Raspberry Pi");
    f.own = std::move(own);
    return f;
}

bool servers_ignore(unsigned card_index, const fs::path& root)
{
    const std::string data = read_trimmed(root / "run/udev/data" / fmt::format("+sound:card{}", card_index));
    return has(data, "E:ACP_IGNORE=1") && has(data, "E:PULSE_IGNORE=1");
}

} // namespace tactor::cli
