// SPDX-License-Identifier: MIT
#include "sink/alsa/devices/cards.hpp"

#include <algorithm>

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

struct listed_device {
    unsigned number = 0;
    std::string name = {};
};

std::vector<listed_device> listed_devices(const fs::path& root, unsigned card_index)
{
    // Lines read "01-00: ID : NAME : playback 1 : capture 1".
    std::vector<listed_device> devices;
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

} // namespace

std::vector<card> sound_cards(const system_root& root)
{
    // Lines read " 1 [DAC8x          ]: HifiberryDac8x - snd_rpi_hifiberry_dac8x", each followed by a line
    // with the long name.
    std::vector<card> cards;
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

std::vector<unsigned> playback_devices(const system_root& root, unsigned card_index)
{
    std::vector<unsigned> numbers;
    for (const listed_device& d : listed_devices(root, card_index))
        numbers.push_back(d.number);
    return numbers;
}

std::string playback_device_name(const system_root& root, unsigned card_index, unsigned device)
{
    for (const listed_device& d : listed_devices(root, card_index))
        if (d.number == device)
            return d.name;
    return {};
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

std::optional<card> find_card(const std::vector<card>& cards, const std::string& id_or_index)
{
    const auto index = detail::number_in<unsigned>(id_or_index);
    const auto found = std::find_if(cards.begin(), cards.end(), [&](const card& c) {
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

} // namespace tactor::alsa
