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

} // namespace

drive_guard::drive_guard(std::size_t channels, std::uint64_t limit, std::uint64_t window, unsigned rate)
    : rate_(rate),
      limit_(static_cast<std::int64_t>(limit)),
      window_(static_cast<std::int64_t>(window)),
      grain_(window_ / static_cast<std::int64_t>(grains) + 1),
      fade_(std::max<std::int64_t>(std::llround(fade_s * rate), 1)),
      pause_(std::max<std::int64_t>(std::llround(pause_s * rate), 1)),
      cells_(limit > 0 && limit < window ? channels : 0)
{
    for (cell& c : cells_)
        c.closed_at = c.opens_at = -fade_;
}

void drive_guard::add(cell& c, const stretch& s) const noexcept
{
    c.sum += s.driven;
    if (c.count > 0) {
        stretch& last = c.at(c.count - 1);
        if (s.begin <= last.end || s.begin - last.begin < grain_ || c.count == c.ring.size()) {
            last.end = std::max(last.end, s.end);
            last.driven += s.driven;
            return;
        }
    }
    ++c.count;
    c.at(c.count - 1) = s;
}

// Releases old frames. Of a stretch that is left in part, keeps as many frames as may have been at its end.
void drive_guard::release(cell& c, std::int64_t begin) noexcept
{
    while (c.count > 0) {
        stretch& s = c.at(0);
        const std::int64_t left = std::min(s.driven, s.end - begin);
        if (left > 0) {
            c.sum -= s.driven - left;
            s.driven = left;
            return;
        }
        c.sum -= s.driven;
        c.first = (c.first + 1) % c.ring.size();
        --c.count;
    }
}

bool drive_guard::drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept
{
    cell& c = cells_[channel];
    const auto end = static_cast<std::int64_t>(to);
    auto at = static_cast<std::int64_t>(from);
    while (at < end) {
        if (at >= c.closed_at && at < c.opens_at) {
            at = c.opens_at; // counted when it was closed
            continue;
        }
        release(c, at + 1 - window_);
        const std::int64_t n = c.sum + (end - at) <= limit_ ? end - at : 1;
        if (c.sum + n > limit_) {
            close(c, at);
        } else {
            add(c, {at, at + n, n});
            at += n;
        }
    }
    return end <= c.closed_at || static_cast<std::int64_t>(from) >= c.opens_at + fade_;
}

void drive_guard::close(cell& c, std::int64_t at) noexcept
{
    add(c, {at, at + fade_, fade_});
    c.closed_at = at;
    c.opens_at = std::max(at + fade_, half_gone(c));
}

/// Returns the first frame whose window holds at most half of the limit, if nothing more is driven.
std::int64_t drive_guard::half_gone(const cell& c) const noexcept
{
    std::int64_t left = limit_ / 2;
    for (std::size_t i = c.count; i-- > 0;) {
        const stretch& s = c.at(i);
        if (s.driven > left)
            return s.end - left + window_;
        left -= s.driven;
    }
    return 0;
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
    const double half = 0.5 * sincos_cycles(0.5 * static_cast<double>(k) / static_cast<double>(fade_)).cos;
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

drive_history drive_guard::history(std::uint64_t clock) const
{
    const auto now = static_cast<std::int64_t>(clock);
    const auto seconds = [&](std::int64_t frames) { return static_cast<double>(frames) / rate_; };
    drive_history h;
    h.channels.resize(cells_.size());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        const cell& c = cells_[i];
        h.channels[i].opens_s = seconds(c.opens_at - now);
        for (std::size_t k = 0; k < c.count; ++k) {
            const stretch& s = c.at(k);
            if (s.end <= now - window_)
                continue;
            h.channels[i].stretches.push_back(
                {seconds(s.begin - now), seconds(s.end - now), seconds(s.driven)});
        }
    }
    return h;
}

void drive_guard::resume(const drive_history& h) noexcept
{
    // A partly driven frame counts, but a rounding error above a whole number does not add a frame.
    const auto up = [this](double s) { return static_cast<std::int64_t>(std::ceil(s * rate_ - 1e-4)); };
    for (std::size_t i = 0; i < std::min(cells_.size(), h.channels.size()); ++i) {
        cell& c = cells_[i];
        for (const drive_history::stretch& s : h.channels[i].stretches)
            add(c, {up(s.begin_s), up(s.end_s), up(s.driven_s)});
        std::int64_t opens = up(h.channels[i].opens_s);
        // A channel closed for a lower limit opens as soon as this guard's limit allows.
        if (const std::int64_t half = half_gone(c); opens > half + fade_)
            opens = half;
        // An open channel starts from silence, so it needs no fade.
        c.opens_at = opens > 0 ? opens : -fade_;
        c.closed_at = std::min(c.opens_at, -fade_);
    }
}

} // namespace tactor::synth
