// SPDX-License-Identifier: MIT
#include "sink/alsa/devices/cards.hpp"

#include <algorithm>
#include <map>

#include <grp.h>
#include <sys/stat.h>

#include "core/split.hpp"
#include "rt/system_files.hpp"

namespace tactor::alsa {
namespace {

namespace fs = std::filesystem;

// Returns NAME of "... ]: DRIVER - NAME".
std::string long_name(const std::string& line)
{
    const auto dash = line.find(" - ");
    return dash == line.npos ? "" : trimmed(line.substr(dash + 3));
}

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
        std::error_code failed;
        const fs::path target = fs::read_symlink(fd, failed);
        if (failed || target.parent_path() != "/dev/snd")
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

std::vector<card_info> sound_cards(const system_root& root)
{
    // Lines read " 1 [DAC8x          ]: HifiberryDac8x - snd_rpi_hifiberry_dac8x", each followed by a line
    // with the long name.
    std::vector<card_info> cards;
    for (const std::string& line : read_lines(root / "proc/asound/cards")) {
        const auto open = line.find('[');
        const auto close = line.find("]:");
        if (open == line.npos || close == line.npos || close < open)
            continue;
        if (const auto index = detail::number_in<unsigned>(trimmed(line.substr(0, open))))
            cards.push_back({*index, trimmed(line.substr(open + 1, close - open - 1)), long_name(line)});
    }
    return cards;
}

std::vector<playback_device> playback_devices(const system_root& root, unsigned card_index)
{
    // Lines read "01-00: ID : NAME : playback 1 : capture 1".
    std::vector<playback_device> devices;
    for (const std::string& line : read_lines(root / "proc/asound/pcm")) {
        const auto dash = line.find('-');
        const auto colon = line.find(':');
        if (dash == line.npos || colon == line.npos || colon < dash || line.find(": playback") == line.npos ||
            detail::number_in<unsigned>(line.substr(0, dash)) != card_index)
            continue;
        const auto d = detail::number_in<unsigned>(line.substr(dash + 1, colon - dash - 1));
        if (d)
            devices.push_back({*d, trimmed(line.substr(colon + 1, line.find(':', colon + 1) - colon - 1))});
    }
    return devices;
}

std::optional<device_name> named_device(std::string_view pcm)
{
    const auto colon = pcm.find(':');
    if (colon == pcm.npos)
        return {};
    const std::string_view plugin = pcm.substr(0, colon);
    std::string_view rest = pcm.substr(colon + 1);
    const bool has_key = rest.substr(0, 5) == "CARD=";
    if (!has_key && plugin != "hw" && plugin != "plughw" && plugin != "dmix" && plugin != "sysdefault")
        return {};
    device_name n;
    const auto comma = rest.find(',');
    n.card = rest.substr(has_key ? 5 : 0, comma == rest.npos ? rest.npos : comma - (has_key ? 5 : 0));
    if (comma != rest.npos) {
        rest.remove_prefix(comma + 1);
        rest = rest.substr(0, rest.find(','));
        if (rest.substr(0, 4) == "DEV=")
            rest.remove_prefix(4);
        n.device = detail::number_in<unsigned>(rest).value_or(0);
    }
    return n;
}

std::optional<card_info> find_card(const std::vector<card_info>& cards, const std::string& id_or_index)
{
    const auto index = detail::number_in<unsigned>(id_or_index);
    const auto found = std::find_if(cards.begin(), cards.end(), [&](const card_info& c) {
        return c.id == id_or_index || (index && c.index == *index);
    });
    return found == cards.end() ? std::nullopt : std::optional(*found);
}

std::string trimmed(std::string_view s)
{
    const auto from = s.find_first_not_of(" \t");
    return from == s.npos ? "" : std::string(s.substr(from, s.find_last_not_of(" \t\n") + 1 - from));
}

std::vector<std::string> read_lines(const fs::path& file)
{
    const std::string text = rt::read_file(file.string());
    std::vector<std::string> lines;
    for (const std::string_view line : tactor::detail::split(text, '\n'))
        lines.emplace_back(line);
    if (lines.back().empty()) // after the last one's end
        lines.pop_back();
    return lines;
}

std::string field(const fs::path& file, std::string_view key)
{
    for (const std::string& line : read_lines(file)) {
        const auto colon = line.find(':');
        if (colon != line.npos && trimmed(line.substr(0, colon)) == key)
            return trimmed(line.substr(colon + 1));
    }
    return {};
}

std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    for (const std::string& name : rt::names_in(folder.string()))
        all.push_back(folder / name);
    return all;
}

std::vector<process_info> playback_holders(const system_root& root, const which_device& wanted)
{
    std::map<int, std::string> found;
    add_all_owners(root / "proc", wanted, found);
    for (const fs::path& process : entries(root / "proc")) {
        const auto pid = detail::number_in<int>(process.filename().string());
        if (pid && !found.contains(*pid) && holds_playback(process, wanted))
            found[*pid] = program_name(process);
    }
    std::vector<process_info> holders;
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
