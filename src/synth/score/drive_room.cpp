// SPDX-License-Identifier: MIT
#include "synth/score/drive_room.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "synth/score/event_source.hpp"

namespace tactor::synth {
namespace {

constexpr double strict = least_counted_drive / 2.0;

// Calls f(channel, greatest amplitude) for each part of an event.
template <class F>
void each_part(const drive_event& e, F f)
{
    for (std::uint32_t i = 0; i < e.drives; ++i)
        f(e.drive[i].channel, std::max(std::abs(e.drive[i].from), std::abs(e.drive[i].to)));
    double most = 0.0;
    for (std::uint32_t i = 0; i < e.points; ++i)
        most = std::max(most, std::abs(e.line.amplitude[i]));
    if (e.points != 0)
        f(e.line.channel, most);
}

// Drives the whole score. Returns true if the guard leaves all its channels open.
bool drive_piece(drive_guard& g, const score& s, std::uint64_t clock)
{
    std::vector<std::uint64_t> until(s.channels(), 0);
    bool open = true;
    event_source source(s);
    for (const drive_event* e = source.peek(); e != nullptr; source.pop(), e = source.peek())
        each_part(*e, [&](std::uint32_t channel, double amplitude) {
            if (amplitude <= strict)
                return;
            const std::uint64_t end = clock + e->start + e->length;
            for (std::uint64_t at = std::max(clock + e->start, until[channel]); at < end;) {
                const std::uint64_t to = std::min(end, at + g.longest_block());
                open = g.drive(channel, at, to) && open;
                at = to;
            }
            until[channel] = std::max(until[channel], end);
        });
    return open;
}

} // namespace

drive_room::drive_room(std::size_t channels, const drive_limits& l, unsigned rate)
    : drive_room(channels, make_guards(l, rate))
{
}

drive_room::drive_room(std::size_t channels, const guard_settings& g)
    : guard_(channels, g.drive_frames, g.window_frames, g.rate), window_(g.window_frames), rate_(g.rate)
{
}

std::optional<std::uint64_t> drive_room::wait(const score& s, std::uint64_t clock) const
{
    if (!guard_.on())
        return 0;
    const auto fits = [&](std::uint64_t later) {
        drive_guard g = guard_;
        return drive_piece(g, s, clock + later);
    };
    if (fits(0))
        return 0;
    std::uint64_t least = 0;
    std::uint64_t most = window_;
    if (!fits(most))
        return std::nullopt;
    while (most - least > rate_ / 20) {
        const std::uint64_t middle = least + (most - least) / 2;
        (fits(middle) ? most : least) = middle;
    }
    return most;
}

void drive_room::played(const score& s, std::uint64_t clock)
{
    if (guard_.on())
        drive_piece(guard_, s, clock);
}

} // namespace tactor::synth
