// SPDX-License-Identifier: MIT
#include "cli/play/play_report.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/say.hpp"
#include "core/words.hpp"
#include "session/sound_server.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

double seconds(std::uint64_t frames, unsigned rate)
{
    return static_cast<double>(frames) / rate;
}

json to_json(const live_delay& d)
{
    return {{"points", d.points}, {"least_s", d.least_s}, {"mean_s", d.mean_s}, {"most_s", d.most_s}};
}

json to_json(const stroke_outcome& s, unsigned rate)
{
    const bool ended = s.report.has_value();
    const std::uint64_t frames = ended ? s.report->frames : 0;
    const bool has_reason = ended && !s.report->why.empty();
    return {{"stroke", s.name},
            {"state", ended ? std::string(to_string(s.report->state)) : "not played"},
            {"frames", frames},
            {"length_frames", s.length_frames},
            {"played_s", seconds(frames, rate)},
            {"late_s", ended ? s.report->late_s : 0.0},
            {"started_ns", ended && s.report->started_ns ? json(*s.report->started_ns) : json(nullptr)},
            {"delay", ended && s.report->delay ? to_json(*s.report->delay) : json(nullptr)},
            {"held_points", ended ? s.report->held_points : 0},
            {"outside_points", ended ? s.report->outside_points : 0},
            {"reason", has_reason ? json(s.report->why) : json(nullptr)}};
}

json to_json(const stream_setup& d)
{
    return {{"pcm", d.name},
            {"channels", d.channels},
            {"device_channels", std::max(d.device_channels, d.channels)},
            {"rate_hz", d.rate},
            {"format", std::string(to_string(d.format))},
            {"period_frames", d.period_frames},
            {"buffer_frames", d.buffer_frames},
            {"latency_ms", session::latency_ms(d)},
            {"batch", d.batch},
            {"has_clock", d.has_clock}};
}

json counters(const run_report& r)
{
    const player_stats& s = r.stats;
    return {{"periods", s.periods},
            {"frames", s.frames},
            {"xruns", s.xruns},
            {"xrun_s", s.xrun_s},
            {"latest_wakeup_s", s.latest_wakeup_s},
            {"ring_low_water", s.ring_low_water},
            {"minor_faults", s.minor_faults},
            {"major_faults", s.major_faults},
            {"limited_frames", s.limited_frames},
            {"power_limited_frames", s.power_limited_frames},
            {"drives_cut", s.drives_cut},
            {"stalls", s.stalls},
            {"off_failures", s.off_failures},
            {"left_on", s.left_on},
            {"sync_pulses", s.sync_pulses},
            {"sync_missed", s.sync_missed},
            {"sync_mean_late_s", s.sync_mean_late_s},
            {"sync_worst_late_s", s.sync_worst_late_s},
            {"reopened", r.reopened},
            {"realtime", s.realtime},
            {"locked_memory", r.locked_memory}};
}

std::string xruns_text(const player_stats& s)
{
    if (s.xruns == 0)
        return "0";
    const auto longest = std::max_element(s.xrun_s.begin(), s.xrun_s.end());
    if (longest == s.xrun_s.end() || *longest <= 0.0)
        return fmt::format("{}", s.xruns);
    return fmt::format("{}, the longest {:.1f} ms", s.xruns, *longest * 1e3);
}

// Returns true if nothing disturbed or limited the strokes.
bool is_clean(const run_report& r)
{
    const player_stats& s = r.stats;
    return s.xruns + s.limited_frames + s.power_limited_frames + s.drives_cut + s.stalls + s.off_failures +
                   s.sync_missed + r.reopened ==
               0 &&
           !s.left_on;
}

// Prints a short table of the counters.
void print_table(std::FILE* to, const run_report& r)
{
    const player_stats& s = r.stats;
    fmt::print(to, "xruns           {}\n", xruns_text(s));
    fmt::print(to, "latest wake-up  {:.3f} ms\n", s.latest_wakeup_s * 1e3);
    fmt::print(to, "ring low water  {}\n", counted(s.ring_low_water, "drive"));
    fmt::print(to, "page faults     {}, {} from disk\n", s.minor_faults + s.major_faults, s.major_faults);
    fmt::print(to, "limited         {}, power in {}, {} cut\n", counted(s.limited_frames, "sample"),
               counted(s.power_limited_frames, "frame"), counted(s.drives_cut, "drive"));
    if (s.stalls != 0)
        fmt::print(to, "stalls          {}, amplifier off in each\n", s.stalls);
    if (s.off_failures != 0)
        fmt::print(to, "off refused     {} by the amplifier's line{}\n", counted(s.off_failures, "time"),
                   s.left_on ? "" : ", off in the end");
    if (s.sync_pulses + s.sync_missed != 0)
        fmt::print(to, "sync pulses     {}, {} missed, late by {:.3f} ms, at worst {:.3f} ms\n",
                   s.sync_pulses, s.sync_missed, s.sync_mean_late_s * 1e3, s.sync_worst_late_s * 1e3);
    if (r.reopened != 0)
        fmt::print(to, "reopened        {}\n", r.reopened);
    fmt::print(to, "real time       {}, memory {}\n", s.realtime ? "yes" : "no",
               r.locked_memory ? "locked" : "not locked");
}

} // namespace

std::string fate(const stroke_outcome& s, unsigned rate)
{
    if (!s.report)
        return "not played";
    const double t = seconds(s.report->frames, rate);
    if (s.report->state == state_kind::finished)
        return fmt::format("played {:.3f} s", t);
    return fmt::format("{} after {:.3f} s{}{}", to_string(s.report->state), t,
                       s.report->why.empty() ? "" : ": ", s.report->why);
}

std::string describe(const stroke_outcome& s, unsigned rate)
{
    std::string text = fmt::format("{}: {}", shown_name(s.name), fate(s, rate));
    if (s.report && s.report->delay) {
        const live_delay& d = *s.report->delay;
        text += fmt::format("; from {} to the DAC {:.1f} ms ({:.1f} to {:.1f})", counted(d.points, "point"),
                            d.mean_s * 1e3, d.least_s * 1e3, d.most_s * 1e3);
    }
    if (s.report && s.report->held_points != 0)
        text += fmt::format("; {} above intensity 1 sounded as 1", counted(s.report->held_points, "point"));
    if (s.report && s.report->outside_points != 0)
        text += fmt::format("; {} outside the array moved to its edge",
                            counted(s.report->outside_points, "point"));
    return text;
}

std::string describe(const stream_setup& d)
{
    return fmt::format("{}: {}, {} Hz, {}, period {} of {} frames, latency {:.1f} ms", d.name,
                       d.device_channels > d.channels
                           ? fmt::format("{} of {} channels", d.channels, d.device_channels)
                           : counted(d.channels, "channel"),
                       d.rate, to_string(d.format), d.period_frames, d.buffer_frames, session::latency_ms(d));
}

std::optional<error> unfinished(const run_report& r)
{
    const stroke_outcome* last = nullptr;
    std::size_t n = 0;
    for (const stroke_outcome& s : r.strokes) {
        if (s.report && s.report->state == state_kind::finished)
            continue;
        last = &s;
        ++n;
    }
    if (last == nullptr)
        return std::nullopt;
    std::string why = fate(*last, r.device.rate);
    if (n > 1)
        why += fmt::format("; {} of {} did not finish", n, counted(r.strokes.size(), "stroke"));
    return error(error_kind::runtime, last->name, why);
}

void print_json(std::FILE* to, const run_report& r)
{
    json strokes = json::array();
    for (const stroke_outcome& s : r.strokes)
        strokes.push_back(to_json(s, r.device.rate));
    const json all{{"schema", "tactor-play/1"},
                   {"device", to_json(r.device)},
                   {"strokes", strokes},
                   {"counters", counters(r)}};
    fmt::print(to, "{}\n", all.dump(2, ' ', false, json::error_handler_t::replace));
}

void tell(const stroke_outcome& s, unsigned rate, bool as_json)
{
    if (!as_json && s.report)
        say(stdout, "{}\n", describe(s, rate));
    flush_output();
}

int hold_run(const settings& s, const environment& e, unsigned channels, unsigned rate, bool as_json,
             std::vector<stroke_outcome> strokes, const playing& play)
{
    session::tell_of_no_device(s, e);
    const alsa_options device = session::device_options(s, s.stream, e, channels, rate);
    const std::string server = session::settle_server(device.pcm);
    session::play_session session(device, s.stream, e);
    if (!as_json)
        say(stdout, "{}\n", describe(session.setup()));
    flush_output();
    const std::string late = session::latency_warning(s.stream.latency_ms, session.setup());
    if (!late.empty())
        say(stderr, "tactor: warning: {}\n", late);
    session::warn_of_server(server);
    run_report r;
    r.strokes = std::move(strokes);
    const auto broken = play(session, r.strokes);
    static_cast<session::run_facts&>(r) = session.finish();
    if (as_json)
        print_json(stdout, r);
    else if (s.stream.verbose || !is_clean(r))
        print_table(stdout, r);
    return judge_run(r, session.signal(), broken);
}

int judge_run(const run_report& r, int signal, const std::optional<error>& broken)
{
    r.check_amplifier();
    if (signal != 0)
        return session::interrupt::status(signal);
    if (broken)
        throw error(*broken);
    if (const auto left = unfinished(r))
        throw error(*left);
    return status_ok;
}

} // namespace tactor::cli
