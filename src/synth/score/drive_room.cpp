// SPDX-License-Identifier: MIT
#include "synth/score/drive_room.hpp"

#include <algorithm>
#include <cmath>

#include "synth/limits/guard.hpp"
#include "synth/score/event_source.hpp"

namespace tactor::synth {
namespace {

constexpr double strict = least_counted_drive / 2.0;

/// Drive time that a piece adds to a channel, in frames. The level after the piece is the maximum of two
/// values: the earlier level plus `sum`, and `rested`, the level after the piece on a rested channel. The
/// same holds within the piece, with `most` and `most_rested`.
struct need {
    double sum = 0.0;
    double most = 0.0; ///< maximum of `sum` within the piece
    double rested = 0.0;
    double most_rested = 0.0;
    std::uint64_t until = 0; ///< frame of the piece up to which drive is counted

    void drive(std::uint64_t from, std::uint64_t to, double leak) noexcept
    {
        const double leaked = leak * static_cast<double>(from - until);
        const auto driven = static_cast<double>(to - from);
        sum += driven - leaked;
        rested = std::max(rested - leaked, 0.0) + driven;
        most = std::max(most, sum);
        most_rested = std::max(most_rested, rested);
        until = to;
    }
};

// Calls f(channel, greatest amplitude) for each part of an event.
template <class F>
void for_each_event_part(const drive_event& e, F f)
{
    for (std::uint32_t i = 0; i < e.drives; ++i)
        f(e.drive[i].channel, std::max(std::abs(e.drive[i].from), std::abs(e.drive[i].to)));
    double most = 0.0;
    for (std::uint32_t i = 0; i < e.points; ++i)
        most = std::max(most, std::abs(e.line.amplitude[i]));
    if (e.points != 0)
        f(e.line.channel, most);
}

std::vector<need> find_needs(const score& s, double leak)
{
    std::vector<need> all(s.channels());
    event_source source(s);
    for (const drive_event* e = source.peek(); e != nullptr; source.pop(), e = source.peek())
        for_each_event_part(*e, [&](std::uint32_t channel, double amplitude) {
            need& n = all[channel];
            const std::uint64_t end = e->start + e->length;
            if (amplitude > strict && end > n.until)
                n.drive(std::max(e->start, n.until), end, leak);
        });
    return all;
}

} // namespace

drive_room::drive_room(std::size_t channels, const drive_limits& l, unsigned rate) : rate_(rate)
{
    const guard_settings g = make_guards(l, rate);
    limit_ = g.drive_frames;
    leak_ = g.leak;
    levels_.resize(limit_ > 0.0 ? channels : 0);
}

double drive_room::level_at(std::size_t channel, std::uint64_t clock) const noexcept
{
    const level& l = levels_[channel];
    return std::max(l.frames - leak_ * static_cast<double>(clock - std::min(clock, l.at)), 0.0);
}

std::optional<std::uint64_t> drive_room::wait(const score& s, std::uint64_t clock) const
{
    if (levels_.empty())
        return 0;
    double frames = 0.0;
    const std::vector<need> needs = find_needs(s, leak_);
    for (std::size_t i = 0; i < std::min(needs.size(), levels_.size()); ++i) {
        if (needs[i].most_rested > limit_)
            return std::nullopt;
        if (needs[i].most > 0.0)
            frames = std::max(frames, (level_at(i, clock) - (limit_ - needs[i].most)) / leak_);
    }
    return static_cast<std::uint64_t>(std::ceil(frames));
}

void drive_room::resume(std::span<const double> levels_s)
{
    for (std::size_t i = 0; i < std::min(levels_.size(), levels_s.size()); ++i)
        levels_[i] = {std::min(levels_s[i] * rate_, limit_), 0};
}

void drive_room::close(std::uint64_t clock)
{
    for (level& l : levels_)
        l = {1.5 * limit_, clock}; // the level is at the limit when the guard opens the channel
}

void drive_room::add_played_score(const score& s, std::uint64_t clock)
{
    if (levels_.empty())
        return;
    const std::vector<need> needs = find_needs(s, leak_);
    for (std::size_t i = 0; i < std::min(needs.size(), levels_.size()); ++i)
        if (needs[i].until > 0)
            levels_[i] = {std::max(level_at(i, clock) + needs[i].sum, needs[i].rested),
                          clock + needs[i].until};
}

} // namespace tactor::synth
