// SPDX-License-Identifier: MIT
// Processes that play on the cards, and the group that may.
#include <map>

#include <grp.h>
#include <sys/stat.h>

#include "core/split.hpp"
#include "sink/alsa/devices/cards.hpp"

namespace tactor::alsa {
namespace {

namespace fs = std::filesystem;

// Returns card and device of "pcmC1D0p", if it is the name of a playback device.
std::optional<which_device> playback_node(const std::string& name)
{
    const auto d = name.find('D');
    if (name.rfind("pcmC", 0) != 0 || name.back() != 'p' || d == name.npos)
        return {};
    const std::string_view n = name;
    const auto card = detail::number_in<unsigned>(n.substr(4, d - 4));
    const auto device = detail::number_in<unsigned>(n.substr(d + 1, n.size() - d - 2));
    if (!card || !device)
        return {};
    return which_device{card, device};
}

bool meets(const which_device& wanted, unsigned card, unsigned device)
{
    return wanted.card.value_or(card) == card && wanted.device.value_or(device) == device;
}

std::string program_name(const fs::path& process)
{
    const auto lines = read_lines(process / "comm");
    return lines.empty() ? "" : trimmed(lines.front());
}

bool holds_playback(const fs::path& process, const which_device& wanted)
{
    for (const fs::path& fd : entries(process / "fd")) {
        std::error_code gone;
        const fs::path target = fs::read_symlink(fd, gone);
        if (gone || target.parent_path() != "/dev/snd")
            continue;
        const auto of = playback_node(target.filename().string());
        if (of && meets(wanted, *of->card, *of->device))
            return true;
    }
    return false;
}

// Adds the thread that opened each busy substream, as the sound driver reports it.
void add_owners(const fs::path& proc, const fs::path& device, std::map<int, std::string>& into)
{
    for (const fs::path& sub : entries(device)) {
        const auto thread = detail::number_in<int>(field(sub / "status", "owner_pid"));
        if (!thread)
            continue;
        const auto process = detail::number_in<int>(field(proc / std::to_string(*thread) / "status", "Tgid"));
        const int pid = process.value_or(*thread);
        into[pid] = program_name(proc / std::to_string(pid));
    }
}

// Adds the owners of all wanted devices, in folders such as card1/pcm0p.
void add_all_owners(const fs::path& proc, const which_device& wanted, std::map<int, std::string>& into)
{
    for (const fs::path& folder : entries(proc / "asound")) {
        const std::string card = folder.filename().string();
        const auto index =
            card.rfind("card", 0) == 0 ? detail::number_in<unsigned>(card.substr(4)) : std::nullopt;
        if (!index)
            continue;
        for (const fs::path& device : entries(folder)) {
            const std::string pcm = device.filename().string();
            if (pcm.rfind("pcm", 0) != 0 || pcm.back() != 'p')
                continue;
            const auto d = detail::number_in<unsigned>(std::string_view(pcm).substr(3, pcm.size() - 4));
            if (d && meets(wanted, *index, *d))
                add_owners(proc, device, into);
        }
    }
}

} // namespace

std::vector<holder> playback_holders(const system_root& root, const which_device& wanted)
{
    std::map<int, std::string> found;
    add_all_owners(root / "proc", wanted, found);
    for (const fs::path& process : entries(root / "proc")) {
        const auto pid = detail::number_in<int>(process.filename().string());
        if (pid && !found.contains(*pid) && holds_playback(process, wanted))
            found[*pid] = program_name(process);
    }
    std::vector<holder> holders;
    for (const auto& [pid, program] : found)
        holders.push_back({pid, program});
    return holders;
}

std::string playback_group(const system_root& root)
{
    for (const fs::path& node : entries(root / "dev/snd")) {
        struct stat s {};
        if (!playback_node(node.filename().string()) || ::stat(node.c_str(), &s) != 0)
            continue;
        const group* g = ::getgrgid(s.st_gid);
        return g != nullptr ? g->gr_name : "";
    }
    return {};
}

} // namespace tactor::alsa
