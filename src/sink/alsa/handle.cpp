// SPDX-License-Identifier: MIT
#include "sink/alsa/handle.hpp"

#include <cerrno>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <sys/eventfd.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/owned.hpp"
#include "core/refused.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/route.hpp"

namespace tactor::alsa {
namespace {

// Returns the negative errno if no file can be opened, else 0. One attempt is enough: if libasound has one
// file open and fails to open another, it gives up the whole configuration.
int probe_descriptors() noexcept
{
    const detail::owned_fd one(::eventfd(0, EFD_CLOEXEC));
    return one ? 0 : -errno;
}

// Returns the error for files that cannot be read, from libasound's messages: "_toplevel_:LINE:COLUMN:WHY"
// comes first and "FILE may be old or corrupted: ..." after it.
error configuration_error(int code, const library_messages& messages)
{
    constexpr std::string_view nameless = "_toplevel_:";
    std::string why = messages.first();
    std::string file;
    const std::string all = messages.all();
    for (const std::string_view line : tactor::detail::split(all, '\n'))
        if (const auto end = line.find(" may be old or corrupted"); end != line.npos && file.empty())
            file = line.substr(0, end);
    if (!file.empty() && why.rfind(nameless, 0) == 0) {
        why.erase(0, nameless.size());
        const auto line = why.find(':');
        const auto column = line == why.npos ? line : why.find(':', line + 1);
        if (column != why.npos) {
            file += ":" + why.substr(0, line);
            why.erase(0, column + 1);
        }
    }
    return {error_kind::not_available, file.empty() ? "ALSA's configuration" : file,
            append_detail("ALSA cannot read its configuration", why.empty() ? snd_strerror(code) : why),
            "repair or remove this file, or one that it includes; ALSA plays nothing until then"};
}

configuration parse(const std::string& text)
{
    const library_messages messages;
    snd_config_t* c = nullptr;
    const int code = snd_config_load_string(&c, text.c_str(), text.size());
    if (code < 0)
        detail::throw_with_cause(error(error_kind::bad_input, "ALSA configuration text",
                                       append_detail(snd_strerror(code), messages.first()),
                                       "see the ALSA documentation of .asoundrc"),
                                 -code);
    return configuration(c);
}

// With SND_PCM_NONBLOCK a busy device gives an error at once instead of an endless wait.
constexpr int mode =
    SND_PCM_NONBLOCK | SND_PCM_NO_AUTO_RESAMPLE | SND_PCM_NO_AUTO_CHANNELS | SND_PCM_NO_AUTO_FORMAT;

surroundings collect_surroundings(snd_config_t* top, const std::string& name, const std::string& messages)
{
    const auto has = [&messages](const std::string& text) { return messages.find(text) != messages.npos; };
    return {.pcms = defined_pcms(top),
            .route = find_route(top, name),
            .bad_arguments = has(fmt::format("Unknown PCM {}\n", name)) && has("Parse arguments error")};
}

} // namespace

configuration read_configuration(const std::string& text)
{
    if (!text.empty())
        return parse(text);
    const library_messages messages;
    snd_config_t* top = nullptr;
    snd_config_update_t* files = nullptr;
    int code = probe_descriptors();
    if (code == 0)
        code = snd_config_update_r(&top, &files, nullptr);
    if (files != nullptr)
        snd_config_update_free(files);
    configuration c(top);
    if (code == -EMFILE || code == -ENFILE)
        tactor::detail::throw_resource_error("ALSA's configuration", -code, snd_strerror(code));
    if (code < 0)
        detail::throw_with_cause(configuration_error(code, messages), -code);
    return c;
}

handle open(const alsa_options& o, snd_config_t* top)
{
    if (const std::string fault = find_fault(top, o.pcm); !fault.empty())
        throw error(error_kind::not_available, fmt::format("PCM \"{}\"", o.pcm), fault,
                    "repair its definition in /etc/asound.conf or ~/.asoundrc: ALSA's library would end this "
                    "program");
    const library_messages messages;
    snd_pcm_t* p = nullptr;
    int code = snd_pcm_open_lconf(&p, o.pcm.c_str(), SND_PCM_STREAM_PLAYBACK, mode, top);
    if (code < 0)
        tactor::detail::throw_with_cause(
            open_error(o.pcm, code, messages.first(), collect_surroundings(top, o.pcm, messages.all())),
            -code);
    handle h(p);
    // Plugins made from other plugins do not always obey the flag of open().
    if (code = snd_pcm_nonblock(h.get(), 1); code < 0)
        tactor::detail::throw_with_cause(open_error(o.pcm, code, messages.first()), -code);
    return h;
}

namespace {

hw_params copy(const hw_params& p)
{
    hw_params q = allocate<hw_params>(snd_pcm_hw_params_malloc);
    snd_pcm_hw_params_copy(q.get(), p.get());
    return q;
}

void check_call(int code, const std::string& name, const char* call)
{
    if (code < 0)
        tactor::detail::throw_with_cause(call_error(name, call, code), -code);
}

// Formats a range. Software PCMs report 1073741823 channels or 4294967295 Hz, which means no limit.
std::string range(unsigned least, unsigned most, unsigned beyond)
{
    if (least == most)
        return fmt::format("{}", least);
    if (most >= beyond)
        return least <= 1 ? "any" : fmt::format("{} or more", least);
    return fmt::format("{} to {}", least, most);
}

std::string formats(const hw_params& p)
{
    const auto mask = allocate<std::unique_ptr<snd_pcm_format_mask_t, deleter<snd_pcm_format_mask_free>>>(
        snd_pcm_format_mask_malloc);
    snd_pcm_hw_params_get_format_mask(p.get(), mask.get());
    std::string names;
    for (const format_kind f : format_preference)
        if (snd_pcm_format_mask_test(mask.get(), to_alsa(f)) != 0)
            names += fmt::format(" {}", to_string(f));
    return names.empty() ? " none that tactor plays" : names;
}

/// Returns a configuration space as text: "channels: 1 to 8; rate in Hz: 44100 to 192000; formats: s32 s16".
std::string describe(const hw_params& p)
{
    unsigned first_channels = 0;
    unsigned last_channels = 0;
    snd_pcm_hw_params_get_channels_min(p.get(), &first_channels);
    snd_pcm_hw_params_get_channels_max(p.get(), &last_channels);
    unsigned least_hz = 0;
    unsigned most_hz = 0;
    int direction = 0;
    snd_pcm_hw_params_get_rate_min(p.get(), &least_hz, &direction);
    snd_pcm_hw_params_get_rate_max(p.get(), &most_hz, &direction);
    if (direction < 0)
        --most_hz; // the bound itself is outside the range
    return fmt::format("channels: {}; rate in Hz: {}; formats:{}",
                       range(first_channels, last_channels, 10000), range(least_hz, most_hz, 10'000'000),
                       formats(p));
}

// Upper bounds of a request: alsa-lib computes with 32 bits.
constexpr unsigned most_rate = 768'000;
constexpr unsigned most_period_frames = 1U << 20;
constexpr unsigned most_periods = 1024;

std::string request_text(const alsa_options& o)
{
    std::string formats;
    if (o.format)
        formats = to_string(*o.format);
    else
        for (const format_kind f : format_preference)
            formats += fmt::format("{}{}", formats.empty() ? "" : ", ", to_string(f));
    return fmt::format("{} channel{} at {} Hz in {}", o.channels, o.channels == 1 ? "" : "s", o.rate,
                       formats);
}

std::span<const format_kind> wanted_formats(const alsa_options& o)
{
    return o.format ? std::span<const format_kind>(&*o.format, 1) : std::span(format_preference);
}

// Returns true if the device supports one of the formats, with any other settings.
bool supports_format(snd_pcm_t* p, const hw_params& space, std::span<const format_kind> formats)
{
    for (const format_kind f : formats)
        if (snd_pcm_hw_params_test_format(p, space.get(), to_alsa(f)) == 0)
            return true;
    return false;
}

// Restricts the space to the requested number of channels. If that fails and `wider` is set, restricts it to
// the next larger number that the device supports. Returns the number; 0 if neither works.
unsigned set_channels(snd_pcm_t* p, const hw_params& h, const alsa_options& o)
{
    if (snd_pcm_hw_params_set_channels(p, h.get(), o.channels) == 0)
        return o.channels;
    unsigned n = o.channels;
    const bool fits = o.wider && snd_pcm_hw_params_set_channels_min(p, h.get(), &n) == 0 &&
                      snd_pcm_hw_params_set_channels_first(p, h.get(), &n) == 0;
    return fits && n <= most_channels ? n : 0;
}

// Returns an error that names each unsupported setting, or the combination if each setting alone is
// supported.
error refused(snd_pcm_t* p, const hw_params& space, const alsa_options& o)
{
    std::string s;
    const auto add = [&s](std::string_view word) { s += fmt::format("{}{}", s.empty() ? "" : ", ", word); };
    const bool has_channels = set_channels(p, copy(space), o) != 0;
    if (!has_channels)
        add("number of channels");
    if (snd_pcm_hw_params_test_rate(p, space.get(), o.rate, 0) != 0)
        add("rate");
    if (!supports_format(p, space, wanted_formats(o)))
        add("format");
    alsa_options wider = o;
    wider.wider = true;
    const bool fits_wider = s == "number of channels" && set_channels(p, copy(space), wider) != 0;
    const std::string why =
        s.empty() ? "it supports each of these alone, but not together" : fmt::format("unsupported {}", s);
    return error(error_kind::not_available, fmt::format("PCM \"{}\"", o.pcm),
                 fmt::format("it cannot play {}: {}", request_text(o), why),
                 fits_wider ? "{wider=true}: tactor then chooses a number that the device has"
                            : fmt::format("use {}", describe(space)))
        .with_field(has_channels ? "" : "channels");
}

struct fixed {
    hw_params params;
    format_kind format;
    unsigned channels;
};

// Fixes format, rate and channels. Each format starts with the whole space, because some devices tie the
// three together.
std::optional<fixed> fix_hw_params(snd_pcm_t* p, const hw_params& space, const alsa_options& o, format_kind f)
{
    hw_params h = copy(space);
    if (snd_pcm_hw_params_set_format(p, h.get(), to_alsa(f)) < 0)
        return std::nullopt;
    // Requires exactly this rate, because a stroke at another rate is another stimulus.
    if (snd_pcm_hw_params_set_rate(p, h.get(), o.rate, 0) < 0)
        return std::nullopt;
    const unsigned n = set_channels(p, h, o);
    return n == 0 ? std::nullopt : std::optional(fixed{std::move(h), f, n});
}

// Returns the first format that fits with the fewest channels.
std::optional<fixed> find_fit(snd_pcm_t* p, const hw_params& space, const alsa_options& o)
{
    std::optional<fixed> best;
    for (const format_kind f : wanted_formats(o))
        if (std::optional<fixed> one = fix_hw_params(p, space, o, f);
            one && (!best || one->channels < best->channels))
            best = std::move(one);
    return best;
}

void set_sizes(snd_pcm_t* p, const hw_params& h, const alsa_options& o)
{
    snd_pcm_hw_params_set_periods_integer(p, h.get()); // some devices refuse this, and work without it
    int direction = 0;
    snd_pcm_uframes_t period = o.period_frames;
    check_call(snd_pcm_hw_params_set_period_size_near(p, h.get(), &period, &direction), o.pcm,
               "snd_pcm_hw_params_set_period_size_near");
    // Sets the buffer as well: otherwise a software PCM chooses hours of frames.
    unsigned periods = o.periods;
    direction = 0;
    if (snd_pcm_hw_params_set_periods_near(p, h.get(), &periods, &direction) == 0)
        return;
    snd_pcm_uframes_t buffer = period * o.periods;
    check_call(snd_pcm_hw_params_set_buffer_size_near(p, h.get(), &buffer), o.pcm,
               "snd_pcm_hw_params_set_buffer_size_near");
}

stream_setup read_back(const hw_params& h, const alsa_options& o, const fixed& asked_for)
{
    stream_setup s{.name = o.pcm, .channels = o.channels, .format = asked_for.format};
    int direction = 0;
    snd_pcm_uframes_t period = 0;
    snd_pcm_uframes_t buffer = 0;
    snd_pcm_hw_params_get_channels(h.get(), &s.device_channels);
    snd_pcm_hw_params_get_rate(h.get(), &s.rate, &direction);
    snd_pcm_hw_params_get_period_size(h.get(), &period, &direction);
    snd_pcm_hw_params_get_buffer_size(h.get(), &buffer);
    s.period_frames = static_cast<unsigned>(period);
    s.buffer_frames = static_cast<unsigned>(buffer);
    s.batch = snd_pcm_hw_params_is_batch(h.get()) != 0;
    snd_pcm_access_t access{};
    snd_pcm_hw_params_get_access(h.get(), &access);
    s.planar = access == SND_PCM_ACCESS_RW_NONINTERLEAVED;
    if (s.device_channels != asked_for.channels || s.rate != o.rate || period == 0 || buffer < period)
        throw error(error_kind::not_available, fmt::format("PCM \"{}\"", o.pcm),
                    fmt::format("{} were requested, but it opened with {} at {} Hz and {} of {} frames",
                                request_text(o), counted(s.device_channels, "channel"), s.rate,
                                s.period_frames, s.buffer_frames),
                    "use the PCM without plugins, such as hw:CARD=NAME");
    return s;
}

} // namespace

void check(const alsa_options& o)
{
    const auto within = [&o](const char* field, const char* thing, unsigned value, unsigned least,
                             unsigned most) {
        if (value < least || value > most)
            throw error(error_kind::bad_input, fmt::format("PCM \"{}\"", o.pcm),
                        fmt::format("{} {} is out of range", value, thing),
                        fmt::format("give {} to {}", least, most))
                .with_field(field);
    };
    within("channels", "channels", o.channels, 1, most_channels);
    within("rate", "Hz", o.rate, 1, most_rate);
    within("period_frames", "frames a period", o.period_frames, detail::min_period_frames(o.rate),
           most_period_frames);
    within("periods", "periods", o.periods, 2, most_periods);
}

hw_params configuration_space(snd_pcm_t* p, const std::string& name)
{
    hw_params h = allocate<hw_params>(snd_pcm_hw_params_malloc);
    check_call(snd_pcm_hw_params_any(p, h.get()), name, "snd_pcm_hw_params_any");
    // Forbids resampling. Not every plugin knows the setting, but open() forbids it as well.
    snd_pcm_hw_params_set_rate_resample(p, h.get(), 0);
    // Some cards, such as RME's, take only planar samples: a block for each channel.
    if (snd_pcm_hw_params_set_access(p, h.get(), SND_PCM_ACCESS_RW_INTERLEAVED) < 0)
        check_call(snd_pcm_hw_params_set_access(p, h.get(), SND_PCM_ACCESS_RW_NONINTERLEAVED), name,
                   "snd_pcm_hw_params_set_access (interleaved or planar)");
    return h;
}

std::string misfit(snd_pcm_t* p, const hw_params& space, const alsa_options& o)
{
    return find_fit(p, space, o) ? std::string() : std::string(refused(p, space, o).why());
}

stream_setup negotiate(snd_pcm_t* p, const alsa_options& o)
{
    const hw_params space = configuration_space(p, o.pcm);
    const std::optional<fixed> best = find_fit(p, space, o);
    if (!best)
        throw error(refused(p, space, o));
    set_sizes(p, best->params, o);
    check_call(snd_pcm_hw_params(p, best->params.get()), o.pcm, "snd_pcm_hw_params");
    return read_back(best->params, o, *best);
}

void set_software_params(snd_pcm_t* p, const stream_setup& s)
{
    const sw_params w = allocate<sw_params>(snd_pcm_sw_params_malloc);
    const auto call = [&s](int code, const char* name) { check_call(code, s.name, name); };
    call(snd_pcm_sw_params_current(p, w.get()), "snd_pcm_sw_params_current");
    snd_pcm_uframes_t boundary = 0;
    call(snd_pcm_sw_params_get_boundary(w.get(), &boundary), "snd_pcm_sw_params_get_boundary");

    // Only snd_pcm_start() starts the DAC, so the instant is known, and the amplifier can follow it.
    call(snd_pcm_sw_params_set_start_threshold(p, w.get(), boundary),
         "snd_pcm_sw_params_set_start_threshold");
    // An underrun stops the DAC. A threshold beyond the buffer would replay old frames for ever.
    call(snd_pcm_sw_params_set_stop_threshold(p, w.get(), s.buffer_frames),
         "snd_pcm_sw_params_set_stop_threshold");
    call(snd_pcm_sw_params_set_avail_min(p, w.get(), s.period_frames), "snd_pcm_sw_params_set_avail_min");
    call(snd_pcm_sw_params_set_tstamp_mode(p, w.get(), SND_PCM_TSTAMP_ENABLE),
         "snd_pcm_sw_params_set_tstamp_mode");
    call(snd_pcm_sw_params_set_tstamp_type(p, w.get(), SND_PCM_TSTAMP_TYPE_MONOTONIC),
         "snd_pcm_sw_params_set_tstamp_type");
    // Overwrites played frames with silence, for a device that runs on past the last frame.
    call(snd_pcm_sw_params_set_silence_threshold(p, w.get(), 0), "snd_pcm_sw_params_set_silence_threshold");
    call(snd_pcm_sw_params_set_silence_size(p, w.get(), boundary), "snd_pcm_sw_params_set_silence_size");
    call(snd_pcm_sw_params(p, w.get()), "snd_pcm_sw_params");
}

} // namespace tactor::alsa
