// SPDX-License-Identifier: MIT
#include "synth/guard/drive_guard.hpp"

#include <algorithm>
#include <cmath>

#include "synth/mix/sincos.hpp"

namespace tactor::synth {
namespace {

constexpr double fade_s = 0.02;
constexpr double pause_s = 0.001; // longer than a sine stays at zero
constexpr double counted = least_counted_drive * least_counted_drive;
constexpr double rounding = 1e-6; // of a level, frames

} // namespace

drive_guard::drive_guard(std::size_t channels, const guard_settings& g)
    : rate_(g.rate),
      limit_(g.drive_frames),
      leak_(g.leak),
      fade_(std::max<std::int64_t>(std::llround(fade_s * g.rate), 1)),
      pause_(std::max<std::int64_t>(std::llround(pause_s * g.rate), 1)),
      cells_(g.drive_frames > 0.0 ? channels : 0)
{
    for (cell& c : cells_)
        c.closed_at = c.opens_at = -fade_;
}

void drive_guard::rest(cell& c, std::int64_t until) const noexcept
{
    if (until <= c.at)
        return;
    c.level = std::max(c.level - leak_ * static_cast<double>(until - c.at), 0.0);
    c.at = until;
}

void drive_guard::add(cell& c, std::int64_t frames) noexcept
{
    c.level += static_cast<double>(frames);
    c.at += frames;
    c.driven += static_cast<std::uint64_t>(frames);
}

bool drive_guard::drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept
{
    cell& c = cells_[channel];
    const auto end = static_cast<std::int64_t>(to);
    auto at = static_cast<std::int64_t>(from);
    while (at < end) {
        if (at >= c.closed_at && at < c.opens_at) {
            at = c.opens_at; // its fade was counted when it was closed
            continue;
        }
        rest(c, at);
        const double room = std::floor(limit_ - c.level + rounding);
        const std::int64_t n =
            room < static_cast<double>(end - at) ? std::max<std::int64_t>(std::llround(room), 0) : end - at;
        add(c, n);
        at += n;
        if (at < end)
            close(c);
    }
    return end <= c.closed_at || static_cast<std::int64_t>(from) >= c.opens_at + fade_;
}

void drive_guard::close(cell& c) const noexcept
{
    c.closed_at = c.at;
    add(c, fade_);
    const double over = c.level - 0.5 * limit_;
    c.opens_at =
        c.at + std::max<std::int64_t>(static_cast<std::int64_t>(std::ceil(over / leak_ - rounding)), 0);
}

void drive_guard::follow(std::size_t channel, std::uint64_t clock, const double* envelope,
                         unsigned n) noexcept
{
    const double* const end = envelope + n;
    const auto driven = [](double e) { return e > counted; };
    for (const double* from = std::find_if(envelope, end, driven); from != end;) {
        const double* const to = std::find_if_not(from, end, driven);
        drive(channel, clock + static_cast<std::uint64_t>(from - envelope),
              clock + static_cast<std::uint64_t>(to - envelope));
        from = std::find_if(to, end, driven);
    }
}

double drive_guard::gain(const cell& c, std::int64_t at) const noexcept
{
    const bool falls = at < c.opens_at;
    const std::int64_t k = at - (falls ? c.closed_at : c.opens_at);
    if (k < 0)
        return 1.0; // it is cut later in this block
    if (k >= fade_)
        return falls ? 0.0 : 1.0;
    const double half = 0.5 * sincos_turns(0.5 * static_cast<double>(k) / static_cast<double>(fade_)).cos;
    return falls ? 0.5 + half : 0.5 - half;
}

bool drive_guard::acts(std::size_t channel, std::uint64_t clock, unsigned n) const noexcept
{
    const cell& c = cells_[channel];
    const auto first = static_cast<std::int64_t>(clock);
    return first + n > c.closed_at && first < c.opens_at + fade_;
}

void drive_guard::apply(std::size_t channel, std::uint64_t clock, unsigned n, double* x, double* envelope,
                        unsigned known) noexcept
{
    cell& c = cells_[channel];
    for (unsigned j = 0; j < n; ++j) {
        const std::int64_t at = static_cast<std::int64_t>(clock) + j;
        const double g = gain(c, at);
        if (g < 1.0 && x[j] != 0.0) {
            cuts_ += at - c.changed_at > pause_ ? 1 : 0;
            c.changed_at = at;
        }
        x[j] *= g;
        if (j >= known)
            envelope[j] *= g * g;
    }
}

void drive_guard::resume(std::span<const double> levels_s) noexcept
{
    for (std::size_t i = 0; i < std::min(cells_.size(), levels_s.size()); ++i)
        cells_[i].level = std::clamp(levels_s[i] * rate_, 0.0, limit_);
}

} // namespace tactor::synth
