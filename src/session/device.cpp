// SPDX-License-Identifier: MIT
#include "session/device.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/tactor.hpp>

#include "core/log.hpp"
#include "core/members.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "files/setup_layers.hpp"
#include "rt/thread.hpp"
#include "session/say.hpp"

namespace tactor::session {
namespace {

// Returns the PCM's name. A name from an array file, which others may have written, can only name a device.
std::string pcm_name(const settings& s, const output_settings& out)
{
    if (s.pcm || !out.pcm)
        return s.pcm.value_or("null");
    if (out.pcm_included) {
        try {
            require_device_name(*out.pcm);
        } catch (const error& x) {
            throw error(x.kind(), out.pcm_at, fmt::format("{}: {}", x.subject(), x.why()),
                        "in an array file, name only a device, such as hw:CARD=Tactor; for other PCMs use "
                        "{device=PCM}");
        }
    }
    return *out.pcm;
}

using detail::about;
using detail::omit_empty;
using detail::omit_usual;

constexpr about both_ends{"both ends"};

template <class Io>
void describe_range_members(Io& io, const count_range& r, const about& ends)
{
    io("min", r.least, ends);
    io.describe_or_null("max", omit_usual(r.most, no_limit), ends);
}

template <class Io>
void describe_ability_members(Io& io, const pcm_abilities& a)
{
    const auto range = [&io](const char* name, const count_range& r, const about& what, const about& ends) {
        io.object(name, what, [&](auto& inner) { describe_range_members(inner, r, ends); });
    };
    io.list("channels", a.channels, {"numbers of channels, as ranges"},
            [](auto& inner, const count_range& r, std::size_t) {
                describe_range_members(inner, r, {"both ends; the search ends at 1024"});
            });
    range("rate_hz", a.rates_hz, {"sample rates"},
          {"both ends; a max of null means no limit, here and below"});
    io("usual_rates_hz", a.usual_rates_hz, {"the usual rates that it supports"});
    io("formats", a.formats, {"as in tactor-play/1"});
    range("period_frames", a.period_frames, {"frames in a period"}, both_ends);
    range("periods", a.periods, {"periods in the buffer"}, both_ends);
    range("buffer_frames", a.buffer_frames, {"frames in the buffer"}, both_ends);
}

template <class Io>
void describe_pcm_members(Io& io, const pcm_info& p, bool is_configured)
{
    io("name", p.name, {"name for -D"});
    io.describe_or_null("description", omit_empty(p.description),
                        {"what the driver or the ALSA configuration calls it; else null"});
    io("hardware", p.hardware, {"whether it is a card's own"});
    io.describe_or_null("preset", omit_empty(p.preset),
                        {"name of the built-in array for this kind of card; else null"});
    io("configured", p.wanted && is_configured, {"whether -D or the configuration names it"});
    io("tried", p.tried, {"whether an attempt was made to open it"});
    io("opened", p.opened, {"whether the attempt succeeded"});
    io.describe_or_null("error", omit_empty(p.error), {"why not; else null"});
    io.list("holders", p.holders, {"processes that have it open"},
            [](auto& inner, const process_info& h, std::size_t) {
                constexpr about process{"process, and name of its program or null"};
                inner("pid", h.pid, process);
                inner.describe_or_null("program", omit_empty(h.program), process);
            });
    io.object_or_null("can", p.can, {"what it supports, each value alone; null if it was not opened"},
                      [](auto& inner, const pcm_abilities& a) { describe_ability_members(inner, a); });
    io.describe_or_null(
        "fits", p.can ? std::optional(p.misfit.empty()) : std::nullopt,
        {"whether it supports what the array needs, and each tactor has its own channel of the "
         "device; null if it was not opened"});
    io.describe_or_null("misfit", omit_empty(p.misfit),
                        {"what it does not support, or which tactor would be lost; else null"});
}

template <class Io>
void describe_chip_members(Io& io, const gpio_chip_info& c)
{
    io("path", c.path, {"device file"});
    io.describe_or_null("label", omit_empty(c.label),
                        {"name of the chip, as for lines in tactor.toml(5); null if it could not be opened"});
    io.describe_or_null("error", omit_empty(c.error), {"why not; else null"});
    io.list("lines", c.lines, {"its lines"}, [](auto& inner, const gpio_line_info& l, std::size_t) {
        inner("offset", l.offset, {"number of the line"});
        inner.describe_or_null("name", omit_empty(l.name), {"its name or null"});
        inner.one_of("direction", l.output ? "output" : "input", {"input", "output"}, {"input or output"});
        inner.describe_or_null("consumer", omit_empty(l.consumer), {"who holds it, or null"});
    });
}

template <class Io>
void describe_list_members(Io& io, const device_list& d)
{
    io.constant("schema", "tactor-devices/1");
    io.object("wanted", {"what the array needs"}, [&d](auto& inner) {
        inner("array", d.array_name, {"its name"});
        inner("channels", d.wanted.channels, {"channels and sample rate"});
        inner("rate_hz", d.wanted.rate, {"channels and sample rate"});
        inner.describe_or_null("format", d.wanted.format, {"value of --sample-format; null means any"});
    });
    io.list("pcms", d.pcms, {"playback devices, cards first"},
            [&d](auto& inner, const pcm_info& p, std::size_t) {
                describe_pcm_members(inner, p, d.pcm_is_configured);
            });
    io.list("gpio_chips", d.chips, {"GPIO chips"},
            [](auto& inner, const gpio_chip_info& c, std::size_t) { describe_chip_members(inner, c); });
}

// Adds facts that depend on the array: a tactor that does not reach the device, or a smaller array that fits.
void add_misfit(const array& a, alsa_options wanted, pcm_info& p)
{
    if (!p.opened)
        return;
    if (p.misfit.empty()) {
        p.misfit = lost_tactor(a, read_wiring(p.name, wanted.channels));
        return;
    }
    wanted.pcm = p.name;
    if (const std::string fit = find_fit(wanted, a); !fit.empty())
        p.misfit += "; " + fit;
}

} // namespace

bool has_configured_pcm(const settings& s, const environment& e)
{
    return s.pcm || e.config.output.pcm;
}

void report_missing_device(const settings& s, const environment& e)
{
    if (!has_configured_pcm(s, e))
        say(stderr, "tactor: no device is configured: playing to \"null\", not to hardware (-D PCM plays on "
                    "hardware)\n");
}

alsa_options device_options(const settings& s, const stream_options& chosen, const environment& e,
                            unsigned channels, unsigned rate)
{
    alsa_options o;
    const output_settings& out = e.config.output;
    o.pcm = pcm_name(s, out);
    o.channels = channels;
    o.wider = !s.channels && !out.channels;
    o.rate = rate;
    o.format = s.format;
    o.periods = chosen.periods.value_or(out.periods.value_or(o.periods));
    o.period_frames = chosen.period_frames.value_or(out.period_frames.value_or(o.period_frames));
    if (chosen.latency_ms) {
        const double frames = *chosen.latency_ms * 1e-3 * o.rate / o.periods;
        o.period_frames = std::max(1U, static_cast<unsigned>(std::lround(frames)));
    }
    return o;
}

drive_limits override_limits(const stream_options& chosen, drive_limits l)
{
    l.power_dbfs = chosen.power_dbfs.value_or(l.power_dbfs);
    l.max_drive_s = chosen.max_drive_s.value_or(l.max_drive_s);
    l.window_s = chosen.drive_window_s.value_or(l.window_s);
    return l;
}

static_assert(drive_limits{}.max_drive_s == detail::usual_drive_s &&
              drive_limits{}.window_s == detail::usual_window_s);

drive_limits find_limits(const stream_options& o, const environment& e)
{
    const limit_settings written = e.config.limits.value_or(limit_settings{});
    return override_limits(o, override_limits({.power_dbfs = written.power_dbfs,
                                               .max_drive_s = written.max_drive_s,
                                               .drive_window_s = written.window_s},
                                              {}));
}

double latency_ms(const stream_setup& s)
{
    return 1e3 * s.buffer_frames / s.rate;
}

std::string latency_warning(std::optional<double> limit_ms, const stream_setup& made)
{
    // Relative difference that rounding to whole frames may make.
    constexpr double tolerance = 1.05;
    if (!limit_ms || latency_ms(made) <= *limit_ms * tolerance + 1e3 / made.rate)
        return {};
    return fmt::format("you requested a latency of {} ms, but the device makes it {:.1f} ms", *limit_ms,
                       latency_ms(made));
}

std::string find_fit(alsa_options o, const array& a)
{
    o.log = {};
    const auto opens = [&o](unsigned channels) {
        o.channels = channels;
        try {
            return open_alsa(o) != nullptr;
        } catch (const error&) {
            return false;
        }
    };
    const unsigned needed = o.channels;
    if (a.channels() < needed)
        return opens(a.channels())
                   ? fmt::format("for the marker or plan, use a spare channel instead of channel {}",
                                 needed - 1)
                   : "";
    std::multimap<unsigned, std::string> by_channels;
    for (const std::string& name : array_presets())
        if (name.starts_with("palm")) // the other presets belong to one kind of card
            by_channels.emplace(preset_array(name).channels(), name);
    for (auto one = by_channels.rbegin(); one != by_channels.rend(); ++one)
        if (one->first < needed && opens(one->first))
            return fmt::format("the array {} fits", one->second);
    return {};
}

void configure_realtime_kit(const stream_options& o) noexcept
{
    rt::set_realtime_helper(o.no_desktop ? nullptr : desktop::request_realtime);
}

std::unique_ptr<sink> open_on_card(const std::function<std::unique_ptr<sink>()>& open, unsigned card_index,
                                   card_claim& c)
{
    const auto give_up = [&c] {
        if (c.idle) {
            c.wanted = true;
            c.news();
        }
        return c.idle.load();
    };
    c.holder.clear();
    for (auto end = std::chrono::steady_clock::time_point::max();;) {
        try {
            return open();
        } catch (const error& e) {
            const bool last = e.os_code() != EBUSY || !c.ask || std::chrono::steady_clock::now() > end;
            if (!last && c.reserved != nullptr) { // the other program is closing the card
                std::this_thread::sleep_for(std::chrono::milliseconds(10));
                continue;
            }
            if (!last)
                c.reserved = desktop::reservation::take(card_index, give_up, c.holder);
            else
                c.reserved.reset();
            c.holder = make_printable(c.holder);
            if (c.reserved == nullptr && (last || c.holder.empty()))
                throw;
            if (c.reserved == nullptr)
                throw e.reworded(e.subject(), e.why(),
                                 fmt::format("{} did not give up the card: {}", c.holder, e.hint()));
            end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
        }
    }
}

std::unique_ptr<sink> open_device(const alsa_options& o, const array& a, card_claim& c)
{
    try {
        const std::optional<card_info> card = read_card(o.pcm);
        std::unique_ptr<sink> s =
            card ? open_on_card([&o] { return open_alsa(o); }, card->index, c) : open_alsa(o);
        if (c.reserved != nullptr)
            detail::log(o.log, log_kind::info, "{} has given up the card until the stream ends", c.holder);
        return s;
    } catch (const error& e) {
        const std::string fit = e.field() == "channels" && o.wider ? find_fit(o, a) : "";
        if (fit.empty())
            throw;
        throw e.reworded(e.subject(), e.why(), fmt::format("{}; {}", e.hint(), fit));
    }
}

std::string prepare_server(const std::string& pcm)
{
    std::string server = read_route(pcm).server;
    // PipeWire's ALSA plugin assigns positions to loudspeaker channels only. Without the variable it would
    // mix nine channels down to the channels that it assumes for the card, usually two.
    if (server == "PipeWire")
        ::setenv("PIPEWIRE_ALSA", "{ stream.dont-remix = true }", 0);
    return server;
}

bool is_felt(const std::string& pcm)
{
    const std::vector<std::string> types = read_route(pcm).types;
    const auto ends_in = [&types](const char* type) {
        return std::find(types.begin(), types.end(), type) != types.end();
    };
    return !ends_in("null") || ends_in("hw");
}

std::string server_note(const std::string& server)
{
    return fmt::format("{} is between player and device, and may mix, resample and hide xruns", server);
}

void warn_of_server(const std::string& server, const char* cure)
{
    if (!server.empty())
        say(stderr, "tactor: warning: {} ({})\n", server_note(server), cure);
}

std::vector<device_note> wiring_notes(const array& a, const stream_setup& s)
{
    std::vector<device_note> all;
    for (std::string& odd : wiring_warnings(a, s.wiring))
        all.push_back({std::move(odd), "set the coefficient to 1 in ttable of the PCM's definition, or "
                                       "use -D hw:CARD=NAME to play on the card itself"});
    const std::string& between = s.wiring.hidden_by;
    if (!between.empty() && read_route(s.name).server.empty())
        all.push_back(
            {fmt::format("it is unknown whether each tactor has its own channel of the device: {} is between",
                         between),
             server_cure});
    return all;
}

device_list examine_devices(const settings& s, const environment& e)
{
    const render_options render = find_render_options(s, e);
    device_list d;
    d.array_name = e.tactors.name;
    d.pcm_is_configured = has_configured_pcm(s, e);
    d.wanted = device_options(s, {}, e, render.channels, render.rate);
    d.pcms = list_pcms(d.wanted);
    for (pcm_info& p : d.pcms)
        add_misfit(e.tactors, d.wanted, p);
    d.chips = list_gpio();
    return d;
}

std::string devices_json(const device_list& d)
{
    return files::make_object([&d](auto& io) { describe_list_members(io, d); }).dump(2) + "\n";
}

nlohmann::ordered_json devices_schema()
{
    return files::json_schema::describe_object([](auto& io) { describe_list_members(io, device_list{}); });
}

} // namespace tactor::session
