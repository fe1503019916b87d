// SPDX-License-Identifier: MIT
#include "alsa/cards.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <system_error>

#include <grp.h>
#include <sys/stat.h>

namespace tactor::pcm {
namespace {

namespace fs = std::filesystem;

template <typename T>
std::optional<T> number(std::string_view text)
{
    T v{};
    const auto r = std::from_chars(text.data(), text.data() + text.size(), v);
    if (r.ec != std::errc() || r.ptr != text.data() + text.size())
        return {};
    return v;
}

std::string trimmed(std::string_view s)
{
    const auto from = s.find_first_not_of(" \t");
    return from == s.npos ? "" : std::string(s.substr(from, s.find_last_not_of(" \t\n") + 1 - from));
}

std::vector<std::string> lines_of(const fs::path& file)
{
    std::vector<std::string> lines;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    return lines;
}

// The value after "key:" in a file of such lines.
std::string field(const fs::path& file, std::string_view key)
{
    for (const std::string& line : lines_of(file)) {
        const auto colon = line.find(':');
        if (colon != line.npos && trimmed(line.substr(0, colon)) == key)
            return trimmed(line.substr(colon + 1));
    }
    return {};
}

std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    std::error_code gone;
    for (fs::directory_iterator i(folder, gone), end; !gone && i != end; i.increment(gone))
        all.push_back(i->path());
    return all;
}

// The card of "pcmC1D0p", if it is the name of a playback device.
std::optional<unsigned> card_of_node(const std::string& name)
{
    const auto d = name.find('D');
    if (name.rfind("pcmC", 0) != 0 || name.back() != 'p' || d == name.npos)
        return {};
    return number<unsigned>(std::string_view(name).substr(4, d - 4));
}

bool holds_playback(const fs::path& process, std::optional<unsigned> wanted)
{
    for (const fs::path& fd : entries(process / "fd")) {
        std::error_code gone;
        const fs::path target = fs::read_symlink(fd, gone);
        if (gone || target.parent_path() != "/dev/snd")
            continue;
        const auto of = card_of_node(target.filename().string());
        if (of && (!wanted || *of == *wanted))
            return true;
    }
    return false;
}

std::string program_of(const fs::path& process)
{
    const auto lines = lines_of(process / "comm");
    return lines.empty() ? "" : trimmed(lines.front());
}

// What the sound driver says: the thread that opened each busy substream.
void add_owners(const fs::path& proc, std::optional<unsigned> wanted, std::map<int, std::string>& into)
{
    for (const fs::path& card : entries(proc / "asound")) {
        const std::string name = card.filename().string();
        const auto index = name.rfind("card", 0) == 0 ? number<unsigned>(name.substr(4)) : std::nullopt;
        if (!index || (wanted && *index != *wanted))
            continue;
        for (const fs::path& device : entries(card)) {
            const std::string pcm = device.filename().string();
            if (pcm.rfind("pcm", 0) != 0 || pcm.back() != 'p')
                continue;
            for (const fs::path& sub : entries(device)) {
                const auto thread = number<int>(field(sub / "status", "owner_pid"));
                if (!thread)
                    continue;
                const auto process = number<int>(field(proc / std::to_string(*thread) / "status", "Tgid"));
                const int pid = process.value_or(*thread);
                into[pid] = program_of(proc / std::to_string(pid));
            }
        }
    }
}

} // namespace

std::vector<card> sound_cards(const system_root& root)
{
    // " 1 [DAC8x          ]: HifiberryDac8x - snd_rpi_hifiberry_dac8x", then a line with the long name.
    std::vector<card> cards;
    for (const std::string& line : lines_of(root / "proc/asound/cards")) {
        const auto open = line.find('[');
        const auto close = line.find("]:");
        if (open == line.npos || close == line.npos || close < open)
            continue;
        if (const auto index = number<unsigned>(trimmed(line.substr(0, open))))
            cards.push_back({*index, trimmed(line.substr(open + 1, close - open - 1))});
    }
    return cards;
}

std::vector<unsigned> playback_devices(const system_root& root, unsigned card_index)
{
    // "01-00: ID : NAME : playback 1 : capture 1"
    std::vector<unsigned> devices;
    for (const std::string& line : lines_of(root / "proc/asound/pcm")) {
        const auto dash = line.find('-');
        const auto colon = line.find(':');
        if (dash == line.npos || colon == line.npos || colon < dash || line.find(": playback") == line.npos ||
            number<unsigned>(line.substr(0, dash)) != card_index)
            continue;
        if (const auto d = number<unsigned>(line.substr(dash + 1, colon - dash - 1)))
            devices.push_back(*d);
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
    const bool said = rest.substr(0, 5) == "CARD=";
    if (!said && plugin != "hw" && plugin != "plughw" && plugin != "dmix" && plugin != "sysdefault")
        return {};
    device_name n;
    const auto comma = rest.find(',');
    n.card = rest.substr(said ? 5 : 0, comma == rest.npos ? rest.npos : comma - (said ? 5 : 0));
    if (comma != rest.npos) {
        rest.remove_prefix(comma + 1);
        rest = rest.substr(0, rest.find(','));
        if (rest.substr(0, 4) == "DEV=")
            rest.remove_prefix(4);
        n.device = number<unsigned>(rest).value_or(0);
    }
    return n;
}

std::optional<card> find_card(const std::vector<card>& cards, const std::string& id_or_index)
{
    const auto index = number<unsigned>(id_or_index);
    const auto found = std::find_if(cards.begin(), cards.end(), [&](const card& c) {
        return c.id == id_or_index || (index && c.index == *index);
    });
    return found == cards.end() ? std::nullopt : std::optional(*found);
}

std::vector<holder> playback_holders(const system_root& root, std::optional<unsigned> card_index)
{
    std::map<int, std::string> found;
    add_owners(root / "proc", card_index, found);
    for (const fs::path& process : entries(root / "proc")) {
        const auto pid = number<int>(process.filename().string());
        if (pid && !found.contains(*pid) && holds_playback(process, card_index))
            found[*pid] = program_of(process);
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
        if (!card_of_node(node.filename().string()) || ::stat(node.c_str(), &s) != 0)
            continue;
        const group* g = ::getgrgid(s.st_gid);
        return g != nullptr ? g->gr_name : "";
    }
    return {};
}

} // namespace tactor::pcm
