// SPDX-License-Identifier: MIT
#include "cli/check/check.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <grp.h>
#include <pwd.h>
#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "cli/devices.hpp"
#include "core/owned.hpp"
#include "core/split.hpp"
#include "rt/thread.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

namespace fs = std::filesystem;

// Returns the entries of a folder, sorted by name, or none if the folder cannot be read.
std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    std::error_code gone;
    for (fs::directory_iterator i(folder, gone), end; !gone && i != end; i.increment(gone))
        all.push_back(i->path());
    std::sort(all.begin(), all.end());
    return all;
}

// Returns the text of a file, or "" if it cannot be read. Removes the last line end, and the zero bytes at
// the end of texts in /proc. Reads with operator<<, which does not throw if the process ends at this moment.
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

std::vector<std::string> own_groups()
{
    std::vector<gid_t> ids(static_cast<std::size_t>(std::max(0, ::getgroups(0, nullptr))));
    ids.resize(static_cast<std::size_t>(std::max(0, ::getgroups(static_cast<int>(ids.size()), ids.data()))));
    ids.push_back(::getegid());
    std::vector<std::string> names;
    for (const gid_t id : ids)
        names.push_back(group_name(id));
    return names;
}

// Tries to open a device. This is necessary because access(2) ignores the device rules of a container. Also
// returns true if another program is using the device.
bool may_open(const fs::path& file)
{
    const detail::owned_fd device(::open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    return device || errno == EBUSY || errno == EAGAIN;
}

// Returns the devices in a folder whose names begin with `begin` and end with `end`.
std::vector<device_node> nodes(const fs::path& folder, std::string_view begin, std::string_view end = "")
{
    std::vector<device_node> all;
    for (const fs::path& f : entries(folder)) {
        struct stat s {};
        const std::string name = f.filename().string();
        if (name.starts_with(begin) && name.ends_with(end) && ::stat(f.c_str(), &s) == 0)
            all.push_back({f.string(), group_name(s.st_gid), may_open(f)});
    }
    return all;
}

// Returns the groups of a user. The file has lines such as "name:x:29:ann,bob".
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
        const auto pid = detail::parse_number_text<int>(process.filename().string());
        const std::string program = pid ? read_trimmed(process / "comm") : "";
        if (std::find(known.begin(), known.end(), program) != known.end())
            all.push_back({*pid, program});
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.pid < b.pid; });
    return all;
}

bool contains(const std::vector<std::string>& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

// Returns a hint about joining a group. A user who has joined the group since the last login must log in
// again.
std::string group_hint(const system_facts& f, const std::string& group)
{
    if (f.root || contains(f.groups, group))
        return "the group may open it, so a container or a unit hides it: name it in docker run --device, or "
               "in DeviceAllow=";
    if (group == "root")
        return "only root may open the device: install the udev rules (tactor-raspberry-pi(7) says how), or "
               "run as root";
    if (contains(f.joined, group) && !contains(f.groups, group))
        return fmt::format("{} is in the group {} already: log out and in again", f.user, group);
    return fmt::format("sudo usermod -aG {} $USER, then log out and in again", group);
}

finding escalate_finding(finding x, bool required)
{
    if (required) {
        x.how = level::error;
        x.kind = error_kind::not_available;
    }
    return x;
}

finding check_nodes(const system_facts& f, const char* check, const std::vector<device_node>& nodes,
                    const char* usual_group, bool needed)
{
    if (nodes.empty())
        return passed(check, fmt::format("no device to open{}", f.root ? "; you are root" : ""),
                      f.root || contains(f.groups, usual_group) || !needed ? "" : group_hint(f, usual_group));
    for (const device_node& n : nodes) {
        if (n.may_open)
            continue;
        return escalate_finding(
            warning(check, fmt::format("no permission to open {}", n.path), group_hint(f, n.group)), needed);
    }
    return passed(
        check, fmt::format("you may open {}{}",
                           nodes.size() == 1 ? nodes.front().path : fmt::format("{} devices", nodes.size()),
                           f.root ? "; you are root" : ", group " + nodes.front().group));
}

const int asked_priority = player_options{}.priority;

finding check_priority(const system_facts& f, const system_needs& n)
{
    if (f.rights.priority >= asked_priority && f.priority_error != 0)
        return escalate_finding(
            warning("real time",
                    fmt::format("no real-time priority, though the limits allow it: {}",
                                std::error_code(f.priority_error, std::generic_category()).message()),
                    "allow SCHED_FIFO in the container or the service"),
            n.require_realtime);
    if (f.rights.priority >= asked_priority)
        return passed("real time",
                      fmt::format("SCHED_FIFO up to {}, {} requested", f.rights.priority, asked_priority));
    if (f.rights.priority == 0 && f.priority > 0)
        return passed("real time", fmt::format("RealtimeKit grants SCHED_FIFO at {}, {} requested",
                                               f.priority, asked_priority));
    const std::string found =
        f.rights.priority == 0
            ? std::string("no real-time priority: RLIMIT_RTPRIO is 0")
            : fmt::format("SCHED_FIFO only up to {}, {} requested", f.rights.priority, asked_priority);
    return escalate_finding(warning("real time", found, rt::realtime_hint(f.rights, asked_priority)),
                            n.require_realtime);
}

finding check_memory(const system_facts& f, const system_needs& n)
{
    constexpr std::uint64_t mib = 1U << 20;
    const std::uint64_t wanted = (f.memory_bytes + mib - 1) / mib;
    if (!f.rights.lockable_bytes)
        return passed("memory", "locked memory without limit");
    const std::uint64_t most = *f.rights.lockable_bytes / mib;
    if (*f.rights.lockable_bytes >= f.memory_bytes)
        return passed("memory", fmt::format("{} MiB of locked memory, {} MiB needed", most, wanted));
    return escalate_finding(
        warning("memory",
                fmt::format("{} MiB of locked memory (RLIMIT_MEMLOCK), {} MiB needed, including a reserve",
                            most, wanted),
                rt::realtime_hint(f.rights, asked_priority)),
        n.require_realtime);
}

finding check_servers(const system_facts& f, const system_needs& n)
{
    constexpr const char* rules =
        "name the card Tactor in the udev rules (70-tactor.rules), which keep sound servers off it; for now: "
        "systemctl --user stop pipewire.socket pipewire wireplumber pulseaudio.socket pulseaudio";
    if (!n.card)
        return passed("sound servers",
                      fmt::format("{}; no card of this machine has \"{}\"",
                                  f.servers.empty() ? "none" : process_names(f.servers), n.pcm));
    const auto is_server = [&](const process_info& p) {
        return std::any_of(f.servers.begin(), f.servers.end(), [&](const auto& s) { return s.pid == p.pid; });
    };
    if (!n.holders.empty())
        return warning("sound servers",
                       fmt::format("{} plays on card {}", process_names(n.holders), n.card->id),
                       std::any_of(n.holders.begin(), n.holders.end(), is_server)
                           ? std::string(rules)
                           : fmt::format("stop that program, such as by kill {}", n.holders.front().pid));
    // JACK uses only the card for which it is configured, so it is not a desktop sound server.
    std::vector<process_info> desktop;
    std::copy_if(f.servers.begin(), f.servers.end(), std::back_inserter(desktop),
                 [](const process_info& p) { return p.program.rfind("jack", 0) != 0; });
    if (desktop.empty())
        return passed("sound servers", "none that would use the card");
    if (n.ignored)
        return passed("sound servers",
                      fmt::format("{}; udev keeps them off card {}", process_names(desktop), n.card->id));
    return warning(
        "sound servers",
        fmt::format("{}: may use card {} at any time, and beep on it", process_names(desktop), n.card->id),
        rules);
}

// Checks whether outputs keep their levels after the program ends, as they may with kernels for the Raspberry
// Pi. This matters if the holder process is killed together with the player: then no process switches the
// amplifier off.
std::vector<finding> check_release(const system_facts& f, const system_needs& n)
{
    if (!n.amplifier)
        return {};
    constexpr const char* cure =
        "put dtparam=strict_gpiod into /boot/firmware/config.txt, then reboot, and wire a pull-down resistor "
        "to the amplifier's enable input; in a service, add ExecStopPost=tactor off";
    if (!f.keeps_outputs.empty())
        return {warning("GPIO release",
                        fmt::format("GPIO lines keep their level after a program ends ({} = Y): if player "
                                    "and holder are both killed, the amplifier stays on",
                                    f.keeps_outputs),
                        cure)};
    if (f.releases_outputs)
        return {passed("GPIO release", "GPIO lines become inputs when their program ends")};
    if (f.raspberry_pi)
        return {warning("GPIO release",
                        "this kernel does not say whether GPIO lines keep their level after a program ends",
                        cure)};
    return {passed(
        "GPIO release",
        "the chip decides what a GPIO line does after a program ends: if player and holder are both "
        "killed, the amplifier may stay on",
        "wire a pull-down resistor to the amplifier's enable input; after such an end run tactor off")};
}

} // namespace

std::string own_user()
{
    const passwd* p = ::getpwuid(::geteuid());
    return p != nullptr ? p->pw_name : "";
}

system_facts read_system(const fs::path& root, const std::string& user)
{
    system_facts f;
    f.root = ::geteuid() == 0;
    f.user = user;
    f.groups = own_groups();
    f.joined = find_groups(user, root / "etc/group");
    f.rights = probe_realtime_rights();
    rt::thread attempt({.name = "tactor-check", .fifo = true, .priority = asked_priority}, [&f] {
        sched_param p{};
        f.priority = ::sched_getparam(0, &p) == 0 ? p.sched_priority : 0;
    });
    attempt.join();
    f.priority_error = attempt.fifo_error();
    f.memory_bytes = session::memory_to_lock();
    f.sound = nodes(root / "dev/snd", "pcmC", "p");
    f.gpio = nodes(root / "dev", "gpiochip");
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
    return f;
}

bool is_ignored_by_servers(unsigned card_index, const fs::path& root)
{
    const std::string data = read_trimmed(root / "run/udev/data" / fmt::format("+sound:card{}", card_index));
    return has(data, "E:ACP_IGNORE=1") && has(data, "E:PULSE_IGNORE=1");
}

std::vector<finding> check_system(const system_facts& f, const system_needs& n)
{
    std::vector<finding> all{check_nodes(f, "sound rights", f.sound, "audio", n.card.has_value()),
                             check_servers(f, n), check_nodes(f, "GPIO rights", f.gpio, "gpio", n.gpio)};
    for (finding& x : check_release(f, n))
        all.push_back(std::move(x));
    all.push_back(check_priority(f, n));
    all.push_back(check_memory(f, n));
    return all;
}

} // namespace tactor::cli
