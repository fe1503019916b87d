// SPDX-License-Identifier: MIT
#include "sink/alsa/error_text.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <string_view>
#include <utility>

#include <alsa/asoundlib.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/refused.hpp"
#include "core/suggest.hpp"
#include "sink/alsa/plain_name.hpp"
#include "sink/alsa/route.hpp"

namespace tactor::alsa {
namespace {

thread_local library_messages* innermost = nullptr;

} // namespace

library_messages::library_messages() noexcept : quiet(&collect), outer_(std::exchange(innermost, this))
{
}

library_messages::~library_messages()
{
    innermost = outer_;
}

void library_messages::collect(const char*, int, const char*, int, const char* format,
                               va_list arguments) noexcept
{
    if (innermost == nullptr)
        return;
    std::array<char, 1000>& text = innermost->text_;
    std::size_t& length = innermost->length_;
    const int n = std::vsnprintf(text.data() + length, text.size() - length, format, arguments);
    length = std::min(length + static_cast<std::size_t>(std::max(n, 0)), text.size() - 2);
    text[length++] = '\n';
}

std::string library_messages::all() const
{
    return {text_.data(), length_};
}

std::string library_messages::first() const
{
    std::string s = all();
    s.resize(std::min(s.find('\n'), s.size()));
    while (!s.empty() && (s.back() == '\n' || s.back() == ' '))
        s.pop_back();
    return s;
}

namespace {

constexpr std::size_t most_names = 12; // maximum number of PCM names in a message
constexpr const char* no_card_hint = "plug in the card, or load its driver or overlay, see "
                                     "{command:devices}; the PCM null needs no card";

std::string describe_pcm(const std::string& name)
{
    return fmt::format("PCM \"{}\"", name);
}

error unavailable(const std::string& name, std::string_view why, std::string_view hint = {})
{
    return {error_kind::not_available, describe_pcm(name), why, hint};
}

std::string suggest_name(const std::string& name, const std::vector<std::string>& known)
{
    const std::vector<std::string_view> views(known.begin(), known.end());
    const std::string_view like = detail::nearest_name(name, views);
    return like.empty() ? "" : fmt::format("did you mean {}? ", like);
}

// Returns a hint about the PCM that the user may have meant: a defined PCM, or a card if only its id or name
// was written.
std::string suggest_name(const std::string& name, const std::vector<card_info>& cards,
                         const std::vector<std::string>& pcms)
{
    std::vector<std::string_view> views;
    for (const card_info& c : cards)
        views.insert(views.end(), {c.id, c.name});
    views.insert(views.end(), pcms.begin(), pcms.end());
    const std::string_view like = detail::nearest_name(name, views);
    if (like.empty())
        return {};
    for (const card_info& c : cards)
        if (like == c.id || like == c.name)
            return fmt::format("did you mean hw:CARD={}? ", c.id);
    return fmt::format("did you mean {}? ", like);
}

std::vector<std::string> ids(const std::vector<card_info>& cards)
{
    std::vector<std::string> all;
    for (const card_info& c : cards)
        all.push_back(c.id);
    return all;
}

error no_card_error(const std::string& name, const device_name& d, const std::vector<card_info>& cards)
{
    if (cards.empty())
        return unavailable(name, "there is no sound card", no_card_hint);
    return unavailable(name, fmt::format("there is no card {}", d.card),
                       fmt::format("{}cards: {}; {{command:devices}} lists all",
                                   suggest_name(d.card, ids(cards)), fmt::join(ids(cards), ", ")));
}

error no_device_error(const std::string& name, unsigned device, const card_info& c, const surroundings& s)
{
    std::vector<unsigned> devices;
    for (const playback_device& d : playback_devices(s.root, c.index))
        devices.push_back(d.number);
    const std::string why = fmt::format("card {} has no playback device {}", c.id, device);
    if (devices.empty())
        return unavailable(name, why, "use another card");
    return unavailable(name, why,
                       fmt::format("use one of its playback devices: {}", fmt::join(devices, ", ")));
}

std::string card_hint(const surroundings& s)
{
    const auto cards = sound_cards(s.root);
    return fmt::format("play on a card: {{device=hw:CARD={}}}; {{command:devices}} lists all",
                       cards.empty() ? "NAME" : cards.front().id);
}

// Returns the name of a missing plugin, such as "pulse", from libasound's message about
// libasound_module_pcm_pulse.so, or about ..._conf_pulse.so, the file of its hooks.
std::string parse_missing_plugin(const std::string& detail)
{
    constexpr std::string_view before = "Cannot open shared library libasound_module_";
    const auto at = detail.find(before);
    const auto end = at == detail.npos ? at : detail.find(".so", at);
    if (end == detail.npos)
        return {};
    const std::string kind_and_name = detail.substr(at + before.size(), end - at - before.size());
    return kind_and_name.substr(kind_and_name.find('_') + 1);
}

// Returns the error of a missing plugin. The hint names Debian's package.
error no_plugin_error(const std::string& name, const std::string& type, const std::string& detail,
                      const surroundings& s)
{
    constexpr std::array bundled{"a52", "jack", "oss", "pulse", "speex", "upmix", "usb_stream", "vdownmix"};
    std::string hint;
    if (type == "pipewire")
        hint = "install the plugin: sudo apt install pipewire-alsa";
    else if (contains(bundled, type))
        hint = "install the plugin: sudo apt install libasound2-plugins";
    else
        hint = fmt::format(
            "check the spelling of the type {} in its definition, or install the package with that file",
            type);
    return unavailable(name, append_detail("a plugin of ALSA's is missing", detail),
                       fmt::format("{}; or {}", hint, card_hint(s)));
}

error no_jack_error(const std::string& name, const surroundings& s)
{
    return unavailable(name, "it leads to JACK, but no JACK server is running",
                       "start jackd or QjackCtl as the user who is logged in, or " + card_hint(s));
}

// Returns true if the route needs a card at its end. An unknown route probably does.
bool needs_card(const surroundings& s)
{
    return s.route.empty() || contains(s.route, "hw");
}

error no_pcm_error(const std::string& name, const std::string& detail, const surroundings& s)
{
    if (const std::string type = parse_missing_plugin(detail); !type.empty())
        return no_plugin_error(name, type, detail, s);
    if (contains(s.route, "jack") && detail.empty())
        return no_jack_error(name, s);
    const auto cards = sound_cards(s.root);
    if (const auto d = parse_device_name(name)) {
        const auto c = find_card(cards, d->card);
        if (!c)
            return no_card_error(name, *d, cards);
        const auto devices = playback_devices(s.root, c->index);
        if (std::none_of(devices.begin(), devices.end(),
                         [&](const auto& p) { return p.number == d->device; }))
            return no_device_error(name, d->device, *c, s);
    }
    const std::string plain = name.substr(0, name.find(':'));
    const bool defined = contains(s.pcms, plain);
    if (defined && cards.empty() && needs_card(s))
        return unavailable(name, append_detail("there is no sound card", detail), no_card_hint);
    if (defined)
        return {
            error_kind::not_available, describe_pcm(name),
            append_detail("its definition in ALSA's configuration refers to something that is not defined",
                          detail),
            "look at the slave of this PCM in /etc/asound.conf and ~/.asoundrc; {command:devices} lists all"};
    std::string hint = suggest_name(plain, cards, s.pcms);
    if (hint.empty() && !s.pcms.empty() && s.pcms.size() <= most_names)
        hint = fmt::format("known: {}; ", fmt::join(s.pcms, ", "));
    if (!cards.empty())
        hint += fmt::format("cards: {}; ", fmt::join(ids(cards), ", "));
    return unavailable(
        name, append_detail("there is no such PCM", detail.starts_with("Unknown PCM ") ? "" : detail),
        hint + "{command:devices} lists all");
}

// Returns the error of a name such as "hw:CARD=Tactor,", with arguments that its definition does not accept.
error arguments_error(const std::string& name, const std::string& detail)
{
    const bool has_reason = detail.rfind("Parse arguments error", 0) != 0;
    return {error_kind::bad_input, describe_pcm(name),
            append_detail("ALSA cannot read the part after the colon",
                          has_reason ? detail : find_plain_name_fault(name)),
            "write a device as hw:CARD=NAME,DEV=NUMBER, or as hw:CARD=NAME; {command:devices} lists all"};
}

error busy_error(const std::string& name, const surroundings& s)
{
    which_device which;
    if (const auto d = parse_device_name(name))
        if (const auto c = find_card(sound_cards(s.root), d->card))
            which.card = c->index;
    const auto holders = playback_holders(s.root, which);
    if (holders.empty())
        return unavailable(name, "it is busy: another program plays on it",
                           "stop that program; sudo fuser -v /dev/snd/* names it");
    constexpr std::array servers{"pipewire", "pipewire-pulse", "wireplumber", "pulseaudio", "jackd"};
    std::string names;
    bool server = false;
    for (const process_info& h : holders) {
        names += fmt::format("{}{} (process {})", names.empty() ? "" : ", ",
                             h.program.empty() ? "a program" : h.program, h.pid);
        server = server || contains(servers, h.program);
    }
    return unavailable(name, fmt::format("it is busy: {} plays on it", names),
                       server ? "install the udev rules, which keep sound servers off the card Tactor"
                              : fmt::format("stop that program, such as by kill {}", holders.front().pid));
}

error permission_error(const std::string& name, const surroundings& s)
{
    const std::string group = playback_group(s.root);
    if (group == "root")
        return unavailable(
            name, "no permission to open it",
            "only root may open /dev/snd: run as root, or let udev give it to the group audio");
    return unavailable(name, "no permission to open it",
                       fmt::format("join the group {0}: sudo usermod -aG {0} $USER, then log in again",
                                   group.empty() ? "audio" : group));
}

// Returns the error for a PCM that needs a sound server while no server runs. The PCM "default" needs one if
// the server's plugin is installed. ALSA's own error text ("Host is down") does not say so.
error no_server_error(const std::string& name, const std::string& detail, const surroundings& s)
{
    const std::string hint = "as the user who is logged in, run systemctl --user start pipewire-pulse or "
                             "pulseaudio --start; or ";
    return {error_kind::not_available, describe_pcm(name),
            append_detail("it leads to a sound server (PipeWire, PulseAudio) that is not running", detail),
            hint + card_hint(s)};
}

} // namespace

std::string append_detail(const std::string& text, const std::string& detail)
{
    return detail.empty() ? text : fmt::format("{}: {}", text, detail);
}

error open_error(const std::string& name, int code, const std::string& detail, const surroundings& s)
{
    if (s.bad_arguments)
        return arguments_error(name, detail);
    switch (-code) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
        return no_pcm_error(name, detail, s);
    case EBUSY:
        return busy_error(name, s);
    case EACCES:
    case EPERM:
        return permission_error(name, s);
    case EHOSTDOWN:
    case EHOSTUNREACH:
    case ECONNREFUSED:
    case ECONNRESET:
    case ENOTCONN:
        return no_server_error(name, detail, s);
    case EMFILE:
    case ENFILE:
        return {error_kind::runtime, describe_pcm(name), append_detail(snd_strerror(code), detail),
                tactor::detail::errno_hint(-code)};
    default:
        return unavailable(name, append_detail(snd_strerror(code), detail),
                           "{command:devices} lists the PCMs");
    }
}

error call_error(const std::string& name, const char* call, int code)
{
    return unavailable(name, fmt::format("{} failed: {}", call, snd_strerror(code)));
}

} // namespace tactor::alsa
