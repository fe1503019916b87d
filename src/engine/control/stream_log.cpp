// SPDX-License-Identifier: MIT
#include "engine/control/stream_log.hpp"

#include <fmt/format.h>

#include "core/words.hpp"
#include "rt/clock.hpp"

namespace tactor::engine {
namespace {

// Returns the growth of a counter since the last look.
std::uint64_t grown(const std::atomic<std::uint64_t>& counter, std::uint64_t& seen) noexcept
{
    const std::uint64_t now = counter.load(std::memory_order_relaxed);
    return now - std::exchange(seen, now);
}

// Returns true if a condition has become true since the last look.
bool rose(bool now, bool& seen) noexcept
{
    return !std::exchange(seen, now) && now;
}

} // namespace

void stream_log::add(log_kind k, std::string text)
{
    lines_.emplace_back(k, std::move(text));
}

void stream_log::look(const stream_status& s, std::int64_t now_ns) noexcept
{
    if (!on())
        return;
    try {
        look_at_stream(s);
        look_at_amplifier(s);
        // Limits act in each period: one line a second is enough.
        if (now_ns - limits_logged_ns_ < rt::ns_per_s && limits_logged_ns_ != 0)
            return;
        const std::size_t before = lines_.size();
        look_at_limits();
        if (lines_.size() != before)
            limits_logged_ns_ = now_ns;
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

void stream_log::look_at_stream(const stream_status& s)
{
    const std::uint64_t xruns = link_.count.xruns.load(std::memory_order_acquire);
    for (; xruns_ < xruns; ++xruns_) {
        const auto& lengths = link_.count.xrun_ns;
        const auto ns = xruns - xruns_ > lengths.size()
                            ? 0
                            : lengths[xruns_ % lengths.size()].load(std::memory_order_relaxed);
        add(log_kind::warning,
            fmt::format("xrun {}: the device ran dry{}", xruns_ + 1,
                        ns == 0 ? ""
                                : fmt::format(" for {}", seconds_text(static_cast<double>(ns) * 1e-9, 3))));
    }
    if (rose(link_.count.realtime_given_up.load(std::memory_order_relaxed), given_up_))
        add(log_kind::warning, "the audio thread gave up its real-time priority: it had worked for some 0.1 "
                               "s without a pause (longer periods, or fewer strokes at once, need less)");
    if (rose(s.stage == stream_stage::suspended, asleep_))
        add(log_kind::warning, "the system sleeps: the stream stands still");
    if (s.running && s.epoch > epoch_) {
        epoch_ = s.epoch;
        add(log_kind::info, fmt::format("the stream runs again, started {} times by now", s.epoch));
    }
}

void stream_log::look_at_amplifier(const stream_status& s)
{
    const amplifier_link& a = link_.amplifier;
    if (grown(link_.count.stalls, stalls_) != 0)
        add(log_kind::warning, "the audio thread, or the whole process, stood still: the amplifier goes off");
    if (const std::uint32_t mutes = a.mutes.load(std::memory_order_acquire);
        std::exchange(mutes_, mutes) != mutes)
        add(log_kind::warning, "the amplifier was muted: what sounded is not felt");
    if (grown(link_.count.off_failures, off_failures_) != 0)
        add(log_kind::error, "the amplifier's line refuses to be switched off: it is tried again");
    if (rose(a.stuck.load(std::memory_order_seq_cst), stuck_))
        add(log_kind::error, "the amplifier may be on: its line was given up");
    if (rose(a.ready.load(std::memory_order_acquire) && s.running, ready_))
        add(log_kind::info, "strokes may sound");
}

void stream_log::look_at_limits()
{
    if (const std::uint64_t n = grown(link_.count.drives_cut, cut_); n != 0)
        add(log_kind::warning,
            fmt::format("{} cut short or silent: a tactor was driven for too long ({} in {} at most)",
                        counted(n, "drive"), seconds_text(limits_.max_drive_s),
                        seconds_text(limits_.window_s)));
    if (const std::uint64_t n = grown(link_.count.power_limited, power_limited_); n != 0)
        add(log_kind::warning, fmt::format("the power of all tactors was held at {} dBFS in {}",
                                           plain_number(limits_.power_dbfs), counted(n, "frame")));
    if (const std::uint64_t n = grown(link_.count.limited, limited_); n != 0)
        add(log_kind::warning, fmt::format("{} held at a channel's own limit", counted(n, "sample")));
}

void stream_log::look_at_end(const stroke_report& r) noexcept
{
    if (!on())
        return;
    try {
        if (r.held_points != 0)
            add(log_kind::warning,
                fmt::format(
                    "live stroke {}: {} above intensity 1 sounded as 1: the level asked for is the ceiling",
                    r.id.number, counted(r.held_points, "point")));
        if (r.outside_points != 0)
            add(log_kind::warning, fmt::format("live stroke {}: {} outside the array moved to its edge",
                                               r.id.number, counted(r.outside_points, "point")));
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

void stream_log::end(const std::string& why) noexcept
{
    if (!on() || std::exchange(over_, true))
        return;
    try {
        look_at_limits();
        add(why.empty() ? log_kind::info : log_kind::error,
            why.empty() ? "the stream has ended" : fmt::format("the stream has ended: {}", why));
    } catch (...) { // NOLINT(bugprone-empty-catch): no memory, no line
    }
}

// Writes the lines. The function may destroy the player, which then looks and writes for the last time.
void stream_log::write() noexcept
{
    const auto lines = std::exchange(lines_, {});
    for (const auto& [kind, text] : lines) {
        try {
            to_(kind, text);
        } catch (...) { // NOLINT(bugprone-empty-catch): a log must not end the stream
        }
    }
}

} // namespace tactor::engine
