// SPDX-License-Identifier: MIT
#include "sink/alsa/devices/cards.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/suggest.hpp"
#include "sink/alsa/devices/plain_name.hpp"
#include "sink/alsa/devices/route.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/library_messages.hpp"
#include "sink/alsa/negotiate.hpp"

namespace tactor::alsa {
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

// Returns a range. The direction says whether a bound itself is outside it.
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

int buffer_least(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* v, int*)
{
    return snd_pcm_hw_params_get_buffer_size_min(p, v);
}

int buffer_most(const snd_pcm_hw_params_t* p, snd_pcm_uframes_t* v, int*)
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
    a.buffer_frames = range(space, buffer_least, buffer_most);
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
                           .holders = playback_holders(root, {c.index, d.number})});
    return all;
}

// Returns the name of a card's own device in the list, for any form of it: hw:1, hw:Tactor, hw:CARD=1,DEV=0.
std::string listed_name(const system_root& root, const std::string& name)
{
    if (const auto d = named_device(name); d && name.rfind("hw:", 0) == 0)
        if (const auto c = find_card(sound_cards(root), d->card))
            return fmt::format("hw:CARD={},DEV={}", c->id, d->device);
    return name;
}

bool is_listed(const std::vector<pcm_info>& all, const std::string& name)
{
    return std::any_of(all.begin(), all.end(), [&](const pcm_info& p) { return p.name == name; });
}

// Removes the name, which the list shows anyway.
std::string without_name(std::string text, const std::string& name)
{
    const std::string prefix = fmt::format("PCM \"{}\": ", name);
    return text.rfind(prefix, 0) == 0 ? text.substr(prefix.size()) : text;
}

// Returns why a PCM is not opened for the list. Empty: it can be opened without effect, or the user wants
// this one, which may start what it needs.
std::string why_not_tried(const std::vector<std::string>& route, bool wanted)
{
    if (writes(route))
        return "not tried: opening a PCM of type file empties its file or starts its command";
    if (std::find(route.begin(), route.end(), endless) != route.end())
        return "not tried: its definition leads to itself, or to too many others";
    const std::string lasting = wanted ? "" : lasting_type(route);
    return lasting.empty()
               ? ""
               : fmt::format("not tried: opening a PCM of type {} may start a card or a server", lasting);
}

void probe(const std::optional<alsa_options>& wanted, snd_config_t* top, pcm_info& p)
{
    p.error = p.hardware ? "" : why_not_tried(find_route(top, p.name), p.wanted);
    p.tried = p.error.empty();
    if (!p.tried)
        return;
    alsa_options o = p.wanted ? *wanted : alsa_options{};
    if (!p.wanted || p.hardware)
        o.pcm = p.name;
    try {
        const configuration own = o.config_text.empty() ? nullptr : read_configuration(o.config_text);
        const handle h = open(o, own == nullptr ? top : own.get());
        look_at(h.get(), wanted, p);
    } catch (const error& e) {
        p.error = without_name(e.what(), o.pcm);
    }
}

} // namespace

void look_at(snd_pcm_t* pcm, const std::optional<alsa_options>& wanted, pcm_info& into)
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
    constexpr const char* hint = "give the name of a device, such as hw:CARD=Tactor";
    const auto thing = [&pcm] { return fmt::format("PCM {}", detail::quoted(pcm)); };
    if (const std::string why = alsa::not_plain(pcm); !why.empty())
        throw error(error_kind::bad_input, thing(), fmt::format("more than the name of a device: {}", why),
                    hint);
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
    const auto d = alsa::named_device(pcm);
    return d ? alsa::find_card(alsa::sound_cards("/"), d->card) : std::nullopt;
}

std::vector<tactor::process_info> tactor::card_holders(unsigned card_index)
{
    return alsa::playback_holders("/", {card_index, {}});
}
