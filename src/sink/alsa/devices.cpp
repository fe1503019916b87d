// SPDX-License-Identifier: MIT
#include "sink/alsa/devices.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>

#include "core/split.hpp"
#include "core/suggest.hpp"
#include "rt/system_files.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/plain_name.hpp"
#include "sink/alsa/route.hpp"

namespace tactor::alsa {
namespace {

namespace fs = std::filesystem;

// Returns a text without the blanks at both ends.
std::string trim_blanks(std::string_view s)
{
    const auto from = s.find_first_not_of(" \t");
    return from == s.npos ? "" : std::string(s.substr(from, s.find_last_not_of(" \t\n") + 1 - from));
}

// Returns the lines of a file; empty if the file cannot be read. Like the functions below, throws error
// (runtime) if the process has no descriptors left.
std::vector<std::string> read_lines(const fs::path& file)
{
    const std::string text = rt::read_file(file.string());
    std::vector<std::string> lines;
    for (const std::string_view line : tactor::detail::split(text, '\n'))
        lines.emplace_back(line);
    if (lines.back().empty()) // text after the last line's end
        lines.pop_back();
    return lines;
}

// Returns the value of a key in a file whose lines are "key: value". Empty if there is none.
std::string field(const fs::path& file, std::string_view key)
{
    for (const std::string& line : read_lines(file)) {
        const auto colon = line.find(':');
        if (colon != line.npos && trim_blanks(line.substr(0, colon)) == key)
            return trim_blanks(line.substr(colon + 1));
    }
    return {};
}

// Returns the name of the built-in array for a USB card. Its USB id or the channel map of a playback device
// identifies the card. Empty if there is none.
std::string find_preset(const system_root& root, unsigned card, unsigned device)
{
    const fs::path folder = root / fmt::format("proc/asound/card{}", card);
    const std::vector<std::string> id = read_lines(folder / "usbid");
    if (!id.empty() && trim_blanks(id.front()) == "054c:0ce6")
        return "dualsense";
    bool plays = false;
    for (const std::string& line : read_lines(folder / fmt::format("stream{}", device))) {
        const std::string text = trim_blanks(line);
        if (text == "Playback:" || text == "Capture:")
            plays = text == "Playback:";
        if (plays && text == "Channel map: FL FR FC LFE RL RR SL SR")
            return "usb-7.1";
    }
    return {};
}

// Returns the entries of a folder, in no particular order.
std::vector<fs::path> entries(const fs::path& folder)
{
    std::vector<fs::path> all;
    for (const std::string& name : rt::read_folder_names(folder.string()))
        all.push_back(folder / name);
    return all;
}

// Returns NAME from a line "... ]: DRIVER - NAME".
std::string parse_long_name(const std::string& line)
{
    const auto dash = line.find(" - ");
    return dash == line.npos ? "" : trim_blanks(line.substr(dash + 3));
}

// Returns card and device from the name of a playback device, such as "pcmC1D0p".
std::optional<which_device> parse_playback_node(const std::string& name)
{
    const auto d = name.find('D');
    if (name.rfind("pcmC", 0) != 0 || name.back() != 'p' || d == name.npos)
        return {};
    const std::string_view n = name;
    const auto card = detail::parse_number_text<unsigned>(n.substr(4, d - 4));
    const auto device = detail::parse_number_text<unsigned>(n.substr(d + 1, n.size() - d - 2));
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
    return lines.empty() ? "" : trim_blanks(lines.front());
}

bool holds_playback(const fs::path& process, const which_device& wanted)
{
    for (const fs::path& fd : entries(process / "fd")) {
        std::error_code failed;
        const fs::path target = fs::read_symlink(fd, failed);
        if (failed || target.parent_path() != "/dev/snd")
            continue;
        const auto of = parse_playback_node(target.filename().string());
        if (of && meets(wanted, *of->card, *of->device))
            return true;
    }
    return false;
}

// Adds the thread that opened each busy substream, as the sound driver reports it.
void add_owners(const fs::path& proc, const fs::path& device, std::map<int, std::string>& into)
{
    for (const fs::path& sub : entries(device)) {
        const auto thread = detail::parse_number_text<int>(field(sub / "status", "owner_pid"));
        if (!thread)
            continue;
        const auto process =
            detail::parse_number_text<int>(field(proc / std::to_string(*thread) / "status", "Tgid"));
        const int pid = process.value_or(*thread);
        into[pid] = program_name(proc / std::to_string(pid));
    }
}

// Adds the owners of all selected devices, from folders such as card1/pcm0p.
void add_all_owners(const fs::path& proc, const which_device& wanted, std::map<int, std::string>& into)
{
    for (const fs::path& folder : entries(proc / "asound")) {
        const std::string card = folder.filename().string();
        const auto index =
            card.rfind("card", 0) == 0 ? detail::parse_number_text<unsigned>(card.substr(4)) : std::nullopt;
        if (!index)
            continue;
        for (const fs::path& device : entries(folder)) {
            const std::string pcm = device.filename().string();
            if (pcm.rfind("pcm", 0) != 0 || pcm.back() != 'p')
                continue;
            const auto d =
                detail::parse_number_text<unsigned>(std::string_view(pcm).substr(3, pcm.size() - 4));
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
        if (const auto index = detail::parse_number_text<unsigned>(trim_blanks(line.substr(0, open))))
            cards.push_back(
                {*index, trim_blanks(line.substr(open + 1, close - open - 1)), parse_long_name(line)});
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
            detail::parse_number_text<unsigned>(line.substr(0, dash)) != card_index)
            continue;
        const auto d = detail::parse_number_text<unsigned>(line.substr(dash + 1, colon - dash - 1));
        if (d)
            devices.push_back(
                {*d, trim_blanks(line.substr(colon + 1, line.find(':', colon + 1) - colon - 1))});
    }
    return devices;
}

std::optional<device_name> parse_device_name(std::string_view pcm)
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
        n.device = detail::parse_number_text<unsigned>(rest).value_or(0);
    }
    return n;
}

std::optional<card_info> find_card(const std::vector<card_info>& cards, const std::string& id_or_index)
{
    const auto index = detail::parse_number_text<unsigned>(id_or_index);
    const auto found = std::find_if(cards.begin(), cards.end(), [&](const card_info& c) {
        return c.id == id_or_index || (index && c.index == *index);
    });
    return found == cards.end() ? std::nullopt : std::optional(*found);
}

std::vector<process_info> playback_holders(const system_root& root, const which_device& wanted)
{
    std::map<int, std::string> found;
    add_all_owners(root / "proc", wanted, found);
    for (const fs::path& process : entries(root / "proc")) {
        const auto pid = detail::parse_number_text<int>(process.filename().string());
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
        if (!parse_playback_node(node.filename().string()) || ::stat(node.c_str(), &s) != 0)
            continue;
        const group* g = ::getgrgid(s.st_gid);
        return g != nullptr ? g->gr_name : "";
    }
    return {};
}

namespace {

constexpr unsigned usual_rates[] = {8000,  11025, 12000, 16000,  22050,  24000,  32000,  44100,  48000,
                                    64000, 88200, 96000, 176400, 192000, 352800, 384000, 705600, 768000};

// Larger numbers mean no limit: software PCMs report 1073741823 channels or 4294967295 Hz, and still larger
// buffers.
constexpr snd_pcm_uframes_t beyond = 1U << 29;

unsigned bounded(snd_pcm_uframes_t n)
{
    return n >= beyond ? no_limit : static_cast<unsigned>(n);
}

// Returns a range. A direction other than 0 means that the bound itself is outside the range.
template <typename Number>
count_range range(const hw_params& p, int (*least)(const snd_pcm_hw_params_t*, Number*, int*),
                  int (*most)(const snd_pcm_hw_params_t*, Number*, int*))
{
    Number low = 0;
    Number high = 0;
    int above = 0;
    int below = 0;
    least(p.get(), &low, &above);
    most(p.get(), &high, &below);
    return {bounded(low + (above > 0 ? 1U : 0U)), bounded(high - (below < 0 && high > 0 ? 1U : 0U))};
}

int get_min_buffer(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* v, int*)
{
    return snd_pcm_hw_params_get_buffer_size_min(p, v);
}

int get_max_buffer(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* v, int*)
{
    return snd_pcm_hw_params_get_buffer_size_max(p, v);
}

// Returns the channel counts, which may have gaps: some cards can do 2, 4 and 8 channels only.
std::vector<count_range> channels(snd_pcm_t* pcm, const hw_params& p)
{
    unsigned least = 0;
    unsigned most = 0;
    snd_pcm_hw_params_get_channels_min(p.get(), &least);
    snd_pcm_hw_params_get_channels_max(p.get(), &most);
    std::vector<count_range> ranges;
    for (unsigned n = std::max(least, 1U); n <= std::min(most, most_channels); ++n) {
        if (snd_pcm_hw_params_test_channels(pcm, p.get(), n) != 0)
            continue;
        if (!ranges.empty() && ranges.back().most + 1 == n)
            ranges.back().most = n;
        else
            ranges.push_back({n, n});
    }
    return ranges;
}

/// Returns the abilities of a configuration space from which open_alsa() would choose. Configures nothing.
pcm_abilities read_abilities(snd_pcm_t* p, const hw_params& space)
{
    pcm_abilities a;
    a.channels = channels(p, space);
    a.rates_hz = range(space, snd_pcm_hw_params_get_rate_min, snd_pcm_hw_params_get_rate_max);
    for (const unsigned hz : usual_rates)
        if (snd_pcm_hw_params_test_rate(p, space.get(), hz, 0) == 0)
            a.usual_rates_hz.push_back(hz);
    for (const format_kind f : format_preference)
        if (snd_pcm_hw_params_test_format(p, space.get(), to_alsa(f)) == 0)
            a.formats.push_back(f);
    a.period_frames =
        range(space, snd_pcm_hw_params_get_period_size_min, snd_pcm_hw_params_get_period_size_max);
    a.periods = range(space, snd_pcm_hw_params_get_periods_min, snd_pcm_hw_params_get_periods_max);
    a.buffer_frames = range(space, get_min_buffer, get_max_buffer);
    return a;
}

std::string joined(const std::string& a, const std::string& b)
{
    return a.empty() || b.empty() || a == b ? (a.empty() ? b : a) : fmt::format("{}, {}", a, b);
}

std::vector<pcm_info> card_devices(const system_root& root)
{
    std::vector<pcm_info> all;
    for (const card_info& c : sound_cards(root))
        for (const playback_device& d : playback_devices(root, c.index))
            all.push_back({.name = fmt::format("hw:CARD={},DEV={}", c.id, d.number),
                           .description = joined(c.name, d.name),
                           .hardware = true,
                           .preset = find_preset(root, c.index, d.number),
                           .holders = playback_holders(root, {c.index, d.number})});
    return all;
}

// Returns the name that a card's device has in the list, for any form of the name: hw:1, hw:Tactor,
// hw:CARD=1,DEV=0.
std::string listed_name(const system_root& root, const std::string& name)
{
    if (const auto d = parse_device_name(name); d && name.rfind("hw:", 0) == 0)
        if (const auto c = find_card(sound_cards(root), d->card))
            return fmt::format("hw:CARD={},DEV={}", c->id, d->device);
    return name;
}

bool is_listed(const std::vector<pcm_info>& all, const std::string& name)
{
    return std::any_of(all.begin(), all.end(), [&](const pcm_info& p) { return p.name == name; });
}

// Removes the name, which the list shows anyway.
std::string strip_pcm_name(std::string text, const std::string& name)
{
    const std::string prefix = fmt::format("PCM \"{}\": ", name);
    return text.rfind(prefix, 0) == 0 ? text.substr(prefix.size()) : text;
}

// Returns why a PCM is not opened for the list. Empty if opening it has no effects, or if the user requested
// this PCM, which may then start a card or a server.
std::string explain_skipped_pcm(const std::vector<std::string>& route, bool wanted)
{
    if (writes(route))
        return "not tried: opening a PCM of type file empties its file or starts its command";
    if (contains(route, endless))
        return "not tried: its definition refers to itself, or to too many others";
    const std::string lasting = wanted ? "" : lasting_type(route);
    return lasting.empty()
               ? ""
               : fmt::format("not tried: opening a PCM of type {} may start a card or a server", lasting);
}

void probe(const std::optional<alsa_options>& wanted, snd_config_t* top, pcm_info& p)
{
    p.error = p.hardware ? "" : explain_skipped_pcm(find_route(top, p.name), p.wanted);
    p.tried = p.error.empty();
    if (!p.tried)
        return;
    alsa_options o = p.wanted ? *wanted : alsa_options{};
    if (!p.wanted || p.hardware)
        o.pcm = p.name;
    try {
        const configuration own = o.config_text.empty() ? nullptr : read_configuration(o.config_text);
        const handle h = open(o, own == nullptr ? top : own.get());
        inspect_pcm(h.get(), wanted, p);
    } catch (const error& e) {
        p.error = strip_pcm_name(e.what(), o.pcm);
    }
}

} // namespace

void inspect_pcm(snd_pcm_t* pcm, const std::optional<alsa_options>& wanted, pcm_info& into)
{
    const library_messages silent;
    const hw_params space = configuration_space(pcm, into.name);
    into.can = read_abilities(pcm, space);
    into.opened = true;
    if (wanted)
        into.misfit = misfit(pcm, space, *wanted);
}

std::vector<pcm_info> list(const system_root& root, const std::optional<alsa_options>& wanted)
{
    std::vector<pcm_info> all = card_devices(root);
    configuration top;
    std::string unread;
    try {
        top = read_configuration();
    } catch (const error& e) {
        if (e.kind() != error_kind::not_available)
            throw;
        unread = e.what();
    }
    for (const known_name& n : known_names(top.get()))
        if (!is_listed(all, listed_name(root, n.name)))
            all.push_back({.name = n.name, .description = n.description});
    if (wanted) {
        const std::string name = listed_name(root, wanted->pcm);
        if (!is_listed(all, name))
            all.push_back({.name = name});
        for (pcm_info& p : all)
            p.wanted = p.name == name;
    }
    for (pcm_info& p : all) {
        p.error = unread;
        if (top != nullptr)
            probe(wanted, top.get(), p);
    }
    return all;
}

} // namespace tactor::alsa

std::vector<tactor::pcm_info> tactor::list_pcms(const std::optional<alsa_options>& wanted)
{
    if (wanted)
        alsa::check(*wanted);
    return alsa::list("/", wanted);
}

tactor::pcm_route tactor::read_route(const std::string& pcm)
{
    pcm_route r;
    r.types = alsa::find_route(pcm);
    r.writes = alsa::writes(r.types);
    r.server = alsa::find_server(r.types);
    return r;
}

tactor::stream_wiring tactor::read_wiring(const std::string& pcm, unsigned channels)
{
    return alsa::find_wiring(alsa::read_configuration().get(), pcm, channels, channels);
}

void tactor::require_device_name(const std::string& pcm)
{
    constexpr const char* hint = "name a device, such as hw:CARD=Tactor";
    const auto thing = [&pcm] { return fmt::format("PCM {}", detail::quoted(pcm)); };
    if (const std::string why = alsa::find_plain_name_fault(pcm); !why.empty())
        throw error(error_kind::bad_input, thing(), why, hint);
    const std::vector<std::string> route = alsa::find_route(pcm);
    if (alsa::writes(route))
        throw error(error_kind::bad_input, thing(), "it writes a file or starts a command", hint);
    if (const std::string type = alsa::unsafe_type(route); !type.empty())
        throw error(error_kind::bad_input, thing(),
                    fmt::format("ALSA's configuration defines it as more than a device: type {}", type),
                    hint);
}

std::optional<tactor::card_info> tactor::read_card(const std::string& pcm)
{
    const auto d = alsa::parse_device_name(pcm);
    return d ? alsa::find_card(alsa::sound_cards("/"), d->card) : std::nullopt;
}

std::vector<tactor::process_info> tactor::card_holders(unsigned card_index)
{
    return alsa::playback_holders("/", {card_index, {}});
}
