// SPDX-License-Identifier: MIT
#include "cli/check/system_facts.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "cli/devices/devices_text.hpp"
#include "rt/thread.hpp"

namespace tactor::cli {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

// Returns the hint for becoming a member. A group that was joined since the login needs a new login.
std::string how_to_join(const system_facts& f, const std::string& group)
{
    if (group == "root")
        return "the device is root's alone: install the udev rules (tactor-raspberry-pi(7) says how), or run "
               "as root";
    if (contains(f.joined, group) && !contains(f.own.groups, group))
        return fmt::format("{} is in the group {} already: log out and in again", f.own.user, group);
    return fmt::format("sudo usermod -aG {} $USER, then log out and in again", group);
}

finding insist(finding x, bool required)
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
        return fine(
            check, fmt::format("no device to open{}", f.own.root ? "; you are root" : ""),
            f.own.root || contains(f.own.groups, usual_group) || !needed ? "" : how_to_join(f, usual_group));
    for (const device_node& n : nodes) {
        if (n.may_open)
            continue;
        return insist(
            warning(check, fmt::format("no permission to open {}", n.path), how_to_join(f, n.group)), needed);
    }
    return fine(check,
                fmt::format("{} may be opened{}",
                            nodes.size() == 1 ? nodes.front().path : fmt::format("{} devices", nodes.size()),
                            f.own.root ? "; you are root" : ", group " + nodes.front().group));
}

finding check_priority(const system_facts& f, const system_needs& n)
{
    if (f.own.rights.priority >= n.priority)
        return fine("real time",
                    fmt::format("SCHED_FIFO up to {}, {} is asked for", f.own.rights.priority, n.priority));
    const std::string found =
        f.own.rights.priority == 0
            ? std::string("no real-time priority: RLIMIT_RTPRIO is 0")
            : fmt::format("SCHED_FIFO up to {} only, {} is asked for", f.own.rights.priority, n.priority);
    return insist(warning("real time", found, rt::realtime_advice(f.own.rights, n.priority)),
                  n.require_realtime);
}

finding check_memory(const system_facts& f, const system_needs& n)
{
    constexpr std::uint64_t mib = 1U << 20;
    const std::uint64_t wanted = (f.own.memory_bytes + mib - 1) / mib;
    if (!f.own.rights.lockable_bytes)
        return fine("memory", "may be locked without limit");
    const std::uint64_t most = *f.own.rights.lockable_bytes / mib;
    if (*f.own.rights.lockable_bytes >= f.own.memory_bytes)
        return fine("memory", fmt::format("{} MiB may be locked, {} MiB must be", most, wanted));
    return insist(
        warning("memory",
                fmt::format("{} MiB may be locked (RLIMIT_MEMLOCK), {} MiB must be, a reserve included", most,
                            wanted),
                rt::realtime_advice(f.own.rights, n.priority)),
        n.require_realtime);
}

finding check_servers(const system_facts& f, const system_needs& n)
{
    constexpr const char* rules =
        "call the card Tactor in the udev rules (70-tactor.rules), which keep them off it; for now: "
        "systemctl --user stop pipewire.socket pipewire wireplumber pulseaudio.socket pulseaudio";
    if (!n.card)
        return fine("sound servers",
                    fmt::format("{}; \"{}\" is on no card of this machine",
                                f.servers.empty() ? "none" : process_names(f.servers), n.pcm));
    const auto is_server = [&](const process_info& p) {
        return std::any_of(f.servers.begin(), f.servers.end(), [&](const auto& s) { return s.pid == p.pid; });
    };
    if (!n.holders.empty())
        return warning("sound servers",
                       fmt::format("{} plays on card {}", process_names(n.holders), n.card->id),
                       std::any_of(n.holders.begin(), n.holders.end(), is_server)
                           ? std::string(rules)
                           : fmt::format("stop it: kill {}", n.holders.front().pid));
    // JACK takes only the card that it is configured for.
    std::vector<process_info> desktop;
    std::copy_if(f.servers.begin(), f.servers.end(), std::back_inserter(desktop),
                 [](const process_info& p) { return p.program.rfind("jack", 0) != 0; });
    if (desktop.empty())
        return fine("sound servers", "none that would take the card");
    if (n.ignored)
        return fine("sound servers",
                    fmt::format("{}; udev keeps them off card {}", process_names(desktop), n.card->id));
    return warning(
        "sound servers",
        fmt::format("{}: may take card {} at any time, and beep on it", process_names(desktop), n.card->id),
        rules);
}

// Checks the level of outputs after their program ended: Raspberry Pi kernels may keep it. That matters if
// the holder is killed together with the player, so that no process switches the amplifier off.
std::vector<finding> check_release(const system_facts& f, const system_needs& n)
{
    if (!n.amplifier)
        return {};
    constexpr const char* cure =
        "dtparam=strict_gpiod in /boot/firmware/config.txt, then reboot, and a pull-down resistor at the "
        "amplifier's enable input; where tactor is a service, ExecStopPost=tactor off";
    if (f.keeps_outputs)
        return {warning(
            "GPIO release",
            fmt::format("{} is Y: a line keeps its level when its program ends, so that nothing switches "
                        "the amplifier off when player and holder are killed together",
                        *f.keeps_outputs),
            cure)};
    if (f.releases_outputs)
        return {fine("GPIO release", "lines become inputs when their program ends")};
    if (f.raspberry_pi)
        return {warning("GPIO release",
                        "this kernel does not say whether lines keep their level when their program ends",
                        cure)};
    return {fine("GPIO release",
                 "what becomes of a line whose program was killed is up to its chip: it may stay on when "
                 "player and holder are killed together",
                 "a pull-down resistor at the amplifier's enable input; after such an end: tactor off")};
}

} // namespace

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
