// SPDX-License-Identifier: MIT
#include "cli/check/system_facts.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <set>

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fmt/format.h>

#include "session/own_memory.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

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

// Finds the preemption in force, which is in brackets: "none voluntary (full)". Older kernels have it only in
// their version.
preemption find_preemption(const std::string& kernel, const fs::path& root)
{
    if (read_trimmed(root / "sys/kernel/realtime") == "1" || has(kernel, "PREEMPT_RT"))
        return preemption::realtime;
    const std::string debug = read_trimmed(root / "sys/kernel/debug/sched/preempt");
    const std::string line = fmt::format(" {} ", read_trimmed(root / "proc/cmdline"));
    const auto chosen = [&](const char* name) {
        return debug.empty() ? has(line, fmt::format(" preempt={} ", name).c_str())
                             : has(debug, fmt::format("({})", name).c_str());
    };
    if (chosen("full") || chosen("lazy"))
        return preemption::full;
    if (chosen("voluntary"))
        return preemption::voluntary;
    if (chosen("none"))
        return preemption::none;
    if (has(kernel, "PREEMPT_DYNAMIC"))
        return preemption::unknown;
    return has(kernel, "PREEMPT") ? preemption::full : preemption::none;
}

std::vector<process_info> find_sound_servers(const fs::path& root)
{
    constexpr std::array known{"pulseaudio",  "pipewire", "pipewire-pulse",
                               "wireplumber", "jackd",    "jackdbus"};
    std::vector<process_info> all;
    for (const process_folder& process : processes(root)) {
        const std::string program = read_trimmed(process.path / "comm");
        if (std::find(known.begin(), known.end(), program) != known.end())
            all.push_back({process.pid, program});
    }
    return all;
}

bool switches_off(const fs::path& unit)
{
    std::ifstream in(unit);
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("ExecStopPost=") && has(line, "tactor off"))
            return true;
    return false;
}

// Returns the units of the system that switch the amplifier off, also by drop-ins
// ("tactor-play@.service.d/off.conf"), each once.
std::vector<std::string> find_off_units(const fs::path& root)
{
    std::set<std::string> all;
    for (const char* folder : {"etc/systemd/system", "run/systemd/system", "usr/local/lib/systemd/system",
                               "usr/lib/systemd/system"})
        for (const fs::path& f : entries(root / folder)) {
            const std::string name = f.filename().string();
            if (name.ends_with(".service") && switches_off(f))
                all.insert(name);
            if (!name.ends_with(".service.d"))
                continue;
            const std::vector<fs::path> parts = entries(f);
            if (std::any_of(parts.begin(), parts.end(), switches_off))
                all.insert(name.substr(0, name.size() - 2));
        }
    return {all.begin(), all.end()};
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
    utsname u{};
    if (::uname(&u) == 0)
        f.kernel = u.version;
    return f;
}

system_facts read_system(own_facts own, const fs::path& root)
{
    system_facts f;
    f.joined = find_groups(own.user, root / "etc/group");
    f.sound = nodes(root / "dev/snd", is_playback);
    f.gpio = nodes(root / "dev", is_chip);
    f.preempts = find_preemption(own.kernel, root);
    std::set<std::string> governors;
    for (const fs::path& cpu : entries(root / "sys/devices/system/cpu"))
        if (const std::string g = read_trimmed(cpu / "cpufreq/scaling_governor"); !g.empty())
            governors.insert(g);
    f.governors.assign(governors.begin(), governors.end());
    f.servers = find_sound_servers(root);
    f.services = find_services(root);
    for (const fs::path& module : entries(root / "sys/module")) {
        const fs::path file = module / "parameters/persist_gpio_outputs";
        const std::string value = read_trimmed(file);
        if (value == "Y" || value == "1")
            f.keeps_outputs = file.string();
        else if (!value.empty())
            f.releases_outputs = true;
    }
    f.off_units = find_off_units(root);
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
