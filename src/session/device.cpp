// SPDX-License-Identifier: MIT
#include "session/device.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/tactor.hpp>

#include "session/say.hpp"

namespace tactor::session {
namespace {

// Returns the PCM's name. One from an array file, which others may have written, can only name a device.
std::string pcm_name(const settings& s, const output_settings& out)
{
    if (s.pcm || !out.pcm)
        return s.pcm.value_or("null");
    if (out.pcm_included) {
        try {
            require_device_name(*out.pcm);
        } catch (const error& x) {
            throw error(x.kind(), out.pcm_at, fmt::format("{}: {}", x.subject(), x.why()),
                        "an array file can only name a device, such as hw:CARD=Tactor; more is taken from "
                        "{device=PCM} "
                        "and from your own configuration: tactor.toml(5), SECURITY CONSIDERATIONS");
        }
    }
    return *out.pcm;
}

} // namespace

bool names_device(const settings& s, const environment& e)
{
    return s.pcm || e.config.output.pcm;
}

void tell_of_no_device(const settings& s, const environment& e)
{
    if (!names_device(s, e))
        say(stderr, "tactor: no device is configured: playing to \"null\", which nobody feels (-D PCM plays "
                    "on hardware)\n");
}

alsa_options device_options(const settings& s, const stream_options& asked, const environment& e,
                            unsigned channels, unsigned rate)
{
    alsa_options o;
    const output_settings& out = e.config.output;
    o.pcm = pcm_name(s, out);
    o.channels = channels;
    o.wider = !s.channels && !out.channels;
    o.rate = rate;
    o.format = s.format;
    o.periods = asked.periods.value_or(out.periods.value_or(o.periods));
    o.period_frames = asked.period_frames.value_or(out.period_frames.value_or(o.period_frames));
    if (asked.latency_ms) {
        const double frames = *asked.latency_ms * 1e-3 * o.rate / o.periods;
        o.period_frames = std::max(1U, static_cast<unsigned>(std::lround(frames)));
    }
    return o;
}

drive_limits limits_over(const stream_options& asked, drive_limits l)
{
    l.power_dbfs = asked.power_dbfs.value_or(l.power_dbfs);
    l.max_drive_s = asked.max_drive_s.value_or(l.max_drive_s);
    l.window_s = asked.drive_window_s.value_or(l.window_s);
    return l;
}

drive_limits settle_limits(const stream_options& o, const environment& e)
{
    const limit_settings written = e.config.limits.value_or(limit_settings{});
    return limits_over(o, limits_over({.power_dbfs = written.power_dbfs,
                                       .max_drive_s = written.max_drive_s,
                                       .drive_window_s = written.window_s},
                                      {}));
}

double latency_ms(const stream_setup& s)
{
    return 1e3 * s.buffer_frames / s.rate;
}

std::string latency_warning(std::optional<double> asked_ms, const stream_setup& made)
{
    // Rounding to whole frames is not worth a sentence.
    constexpr double tolerance = 1.05;
    if (!asked_ms || latency_ms(made) <= *asked_ms * tolerance + 1e3 / made.rate)
        return {};
    return fmt::format("a latency of {} ms was asked for, the device makes it {:.1f} ms", *asked_ms,
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
        return opens(a.channels()) ? fmt::format("the array {} fits, but not channel {}, which a marker or a "
                                                 "plan asks for: choose a spare channel of the device",
                                                 a.name, needed - 1)
                                   : "";
    std::multimap<unsigned, std::string> by_channels;
    for (const std::string& name : array_presets())
        by_channels.emplace(preset_array(name).channels(), name);
    for (auto one = by_channels.rbegin(); one != by_channels.rend(); ++one)
        if (one->first < needed && opens(one->first))
            return fmt::format("the array {} fits", one->second);
    return {};
}

std::string find_drive_doubt(const std::string& device)
{
    const std::string why = device.empty() ? std::string() : drive_time_fault(device);
    return why.empty() || !is_felt(device)
               ? std::string()
               : fmt::format("{}: the next run will not know for how long the array was driven", why);
}

std::unique_ptr<sink> open_device(const alsa_options& o, const array& a)
{
    try {
        return open_alsa(o);
    } catch (const error& e) {
        const std::string fit = e.field() == "channels" && o.wider ? find_fit(o, a) : "";
        if (fit.empty())
            throw;
        throw e.reworded(e.subject(), e.why(), fmt::format("{}; {}", e.hint(), fit));
    }
}

std::string settle_server(const std::string& pcm)
{
    std::string server = read_route(pcm).server;
    // Channels have no places to PipeWire's ALSA plugin beyond those of loudspeakers: it would mix nine of
    // them down to what it takes the card for, as a rule to two.
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
    return fmt::format("{} is in between: it may mix, resample and hide xruns", server);
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
        all.push_back({std::move(odd),
                       "set the coefficient to 1 where the PCM is defined (ttable), or play on "
                       "the card itself, -D hw:CARD=NAME"});
    const std::string& between = s.wiring.hidden_by;
    if (!between.empty() && read_route(s.name).server.empty())
        all.push_back(
            {fmt::format("whether each tactor has a channel of the device to itself is not known: {} "
                         "is between",
                         between),
             server_cure});
    return all;
}

} // namespace tactor::session
