// SPDX-License-Identifier: MIT
#include "cli/play/play.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/members.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "files/plan/plan_members.hpp"
#include "session/device.hpp"

namespace tactor::cli {
namespace {

using detail::about;

double seconds(std::uint64_t frames, unsigned rate)
{
    return static_cast<double>(frames) / rate;
}

template <class Io>
void describe_stroke_members(Io& io, const stroke_outcome& s, unsigned rate)
{
    const bool ended = s.report.has_value();
    const stroke_report r = s.report.value_or(stroke_report{});
    const std::uint64_t frames = ended ? r.frames : 0;
    io("stroke", s.name, {"as the command line names it"});
    io.one_of("state", ended ? to_string(r.state) : "not played",
              {"finished", "cancelled", "interrupted", "not played"},
              {"finished, cancelled, interrupted or not played"});
    io("frames", frames, {"number of frames that played"});
    io("length_frames", s.length_frames, {"number of frames that it has, in one round"});
    io.describe_or_null(
        "rounds", s.rounds,
        {"number of rounds, with --repeat; null for a live stroke, and if a server repeated it"});
    io("played_s", seconds(frames, rate), {"time that it played", detail::from_0});
    files::describe_weakening_members(io, s.weakened);
    io("late_s", r.late_s, {"delay of its start after the requested time", detail::from_0});
    io.describe_or_null(
        "started_ns", r.started_ns,
        {"CLOCK_MONOTONIC of its first sample at the DAC; null if it did not sound or the clock of "
         "the DAC was unknown"});
    io.object_or_null(
        "delay", r.delay,
        {"for the points of a live stroke: time from reading a point to the first frame at the DAC that it "
         "changed; null if no point sounded, and for other strokes"},
        [](auto& inner, const live_delay& d) {
            constexpr about of_them{"smallest, mean and largest delay"};
            inner("points", d.points,
                  {"number of points, without those that a newer one replaced before the next period"});
            inner("least_s", d.least_s, of_them);
            inner("mean_s", d.mean_s, of_them);
            inner("most_s", d.most_s, of_them);
        });
    io("held_points", r.held_points,
       {"points of a live stroke with an intensity above 1, which played as 1"});
    io("outside_points", r.outside_points,
       {"points of a live stroke outside the array, which moved to its edge"});
    io.describe_or_null("reason", detail::omit_empty(r.why), {"why it was interrupted; else null"});
}

template <class Io>
void describe_device_members(Io& io, const stream_setup& d)
{
    io("pcm", d.name, {"its name"});
    io("channels", d.channels, {"channels in use"});
    io("device_channels", std::max(d.device_channels, d.channels),
       {"channels of the device; those not in use are silent"});
    io("rate_hz", d.rate, {"sample rate"});
    io("format", d.format, {"of its samples: float, s16, s24 (three bytes), s24-4 (four) or s32"});
    io("period_frames", d.period_frames, {"lengths of period and buffer"});
    io("buffer_frames", d.buffer_frames, {"lengths of period and buffer"});
    io("latency_ms", session::latency_ms(d), {"length of the buffer", detail::from_0});
    io("batch", d.batch, {"whether its position moves by whole periods"});
    io("has_clock", d.has_clock, {"whether it has its own clock, which null and files do not have"});
}

template <class Io>
void describe_counter_members(Io& io, const play_report& r)
{
    constexpr about written{"written to the device"};
    constexpr about faults{"page faults of the audio thread; the latter waited for a disk"};
    constexpr about pulses{"pulses sent on the line of [sync], and pulses missed"};
    constexpr about late{"how late they were relative to the clock of the DAC"};
    const player_stats& s = r.stats;
    io("periods", s.periods, written);
    io("frames", s.frames, written);
    io("xruns", s.xruns, {"how often the device ran dry"});
    io("xrun_s", s.xrun_s,
       {"lengths of the newest 64, oldest first; 0 if the device cannot tell", detail::from_0});
    io("latest_wakeup_s", s.latest_wakeup_s,
       {"longest time beyond a period until the audio thread woke up", detail::from_0});
    io("ring_low_water", s.ring_low_water,
       {"smallest number of drives that waited for the audio thread while a stroke played"});
    io("minor_faults", s.minor_faults, faults);
    io("major_faults", s.major_faults, faults);
    io("limited_frames", s.limited_frames, {"samples that a tactor's max_dbfs changed"});
    io("power_limited_frames", s.power_limited_frames,
       {"frames in which the limit on the power of all tactors together acted"});
    io("drives_cut", s.drives_cut,
       {"drives that were cut short, or silent, because their tactor had been driven for too long"});
    io("stalls", s.stalls, {"how often the amplifier was switched off because the player stood still"});
    io("off_failures", s.off_failures, {"how often its line refused to switch off"});
    io("left_on", s.left_on, {"whether the last try failed: the amplifier may be on"});
    io("sync_pulses", s.sync_pulses, pulses);
    io("sync_missed", s.sync_missed, pulses);
    io("sync_mean_late_s", s.sync_mean_late_s, late);
    io("sync_worst_late_s", s.sync_worst_late_s, late);
    io("reopened", r.reopened, {"how often a lost device was opened again"});
    io("realtime", s.realtime, {"whether the thread got real-time priority, and kept it"});
    io("locked_memory", r.locked_memory, {"whether the memory was locked"});
}

template <class Io>
void describe_report_members(Io& io, const play_report& r)
{
    io.constant("schema", "tactor-play/1");
    io.object("device", {"the device as it was opened"},
              [&r](auto& inner) { describe_device_members(inner, r.device); });
    io.list("strokes", r.strokes, {"one for each STROKE, in order"},
            [&r](auto& inner, const stroke_outcome& s, std::size_t) {
                describe_stroke_members(inner, s, r.device.rate);
            });
    io.object("counters", {"for the whole run"}, [&r](auto& inner) { describe_counter_members(inner, r); });
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

} // namespace

void add_report(std::optional<stroke_report>& sum, stroke_report r)
{
    if (sum) {
        r.frames += sum->frames;
        r.started_ns = sum->started_ns ? sum->started_ns : r.started_ns;
        r.late_s = std::max(r.late_s, sum->late_s);
        if (sum->state != state_kind::finished) {
            r.state = sum->state;
            r.why = sum->why;
        }
    }
    sum = std::move(r);
}

std::string outcome_text(const stroke_outcome& s, unsigned rate)
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
    std::string text = fmt::format("{}: {}", shown_name(s.name), outcome_text(s, rate));
    if (s.weakened.weakened_db < 0.0)
        text += fmt::format("; weakened by {:.2f} dB", -s.weakened.weakened_db);
    if (s.report && s.report->delay) {
        const live_delay& d = *s.report->delay;
        text += fmt::format("; from {} to the DAC {:.1f} ms ({:.1f} to {:.1f})", counted(d.points, "point"),
                            d.mean_s * 1e3, d.least_s * 1e3, d.most_s * 1e3);
    }
    if (s.report && s.report->held_points != 0)
        text += fmt::format("; {} above intensity 1 played as 1", counted(s.report->held_points, "point"));
    if (s.report && s.report->outside_points != 0)
        text += fmt::format("; {} outside the array moved to its edge",
                            counted(s.report->outside_points, "point"));
    if (s.report && !s.report->doubt.empty())
        text += "; " + s.report->doubt;
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

std::optional<error> find_final_error(const play_report& r)
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
    std::string why = outcome_text(*last, r.device.rate);
    if (n > 1)
        why += fmt::format("; {} of {} did not finish", n, counted(r.strokes.size(), "stroke"));
    return error(error_kind::runtime, last->name, why);
}

void print_json(const play_report& r)
{
    const auto all = files::make_object([&r](auto& io) { describe_report_members(io, r); });
    fmt::print("{}\n", all.dump(2));
}

bool is_undisturbed(const play_report& r)
{
    const player_stats& s = r.stats;
    return s.xruns + s.limited_frames + s.power_limited_frames + s.drives_cut + s.stalls + s.off_failures +
                   s.sync_missed + r.reopened ==
               0 &&
           !s.left_on;
}

void print_table(const play_report& r)
{
    const player_stats& s = r.stats;
    fmt::print("xruns           {}\n", xruns_text(s));
    fmt::print("latest wake-up  {:.3f} ms\n", s.latest_wakeup_s * 1e3);
    fmt::print("ring low water  {}\n", counted(s.ring_low_water, "drive"));
    fmt::print("page faults     {}, {} from disk\n", s.minor_faults + s.major_faults, s.major_faults);
    fmt::print("limited         {}, power in {}, {} cut\n", counted(s.limited_frames, "sample"),
               counted(s.power_limited_frames, "frame"), counted(s.drives_cut, "drive"));
    if (s.stalls != 0)
        fmt::print("stalls          {}, amplifier off in each\n", s.stalls);
    if (s.off_failures != 0)
        fmt::print("off refused     {} by the amplifier's line{}\n", counted(s.off_failures, "time"),
                   s.left_on ? "" : ", off in the end");
    if (s.sync_pulses + s.sync_missed != 0)
        fmt::print("sync pulses     {}, {} missed, late by {:.3f} ms, at worst {:.3f} ms\n", s.sync_pulses,
                   s.sync_missed, s.sync_mean_late_s * 1e3, s.sync_worst_late_s * 1e3);
    if (r.reopened != 0)
        fmt::print("reopened        {}\n", r.reopened);
    fmt::print("real time       {}, memory {}\n", s.realtime ? "yes" : "no",
               r.locked_memory ? "locked" : "not locked");
}

nlohmann::ordered_json play_schema()
{
    return files::json_schema::describe_object([](auto& io) { describe_report_members(io, play_report{}); });
}

void print_outcome(const stroke_outcome& s, unsigned rate, bool as_json)
{
    if (!as_json && s.report)
        say(stdout, "{}\n", describe(s, rate));
    flush_output();
}

int find_run_status(const play_report& r, int signal, const std::optional<error>& broken)
{
    r.check_amplifier();
    if (signal != 0)
        return session::interrupt::status(signal);
    if (broken)
        throw error(*broken);
    if (const auto left = find_final_error(r))
        throw error(*left);
    return status_ok;
}

} // namespace tactor::cli
