// SPDX-License-Identifier: MIT
#include "synth/limits/guard.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/refused.hpp"
#include "synth/wave/oscillator.hpp"

namespace tactor::synth {
namespace {

void check_limits(const drive_limits& l)
{
    if (!detail::bounds_of::power_dbfs.holds(l.power_dbfs))
        throw detail::bad_field("power_dbfs", fmt::format("{} dBFS is not a power limit", l.power_dbfs),
                                "give -120 to 60 dB, such as 4.77, three channels at full scale");
    if (!detail::bounds_of::drive_s.holds(l.max_drive_s))
        throw detail::bad_field("max_drive_s", fmt::format("{} s is not a limit", l.max_drive_s),
                                "give 0.1 to 3600 s, such as 5");
    if (!detail::bounds_of::drive_s.holds(l.window_s))
        throw detail::bad_field("window_s", fmt::format("{} s is not a window", l.window_s),
                                "give 0.1 to 3600 s, such as 10");
}

} // namespace

guard_settings make_guards(const drive_limits& l, unsigned rate)
{
    check_limits(l);
    guard_settings g;
    g.rate = rate;
    g.power = std::pow(10.0, l.power_dbfs / 10.0);
    if (l.max_drive_s < l.window_s) {
        g.drive_frames = std::round(l.max_drive_s * rate);
        g.leak = l.max_drive_s / (l.window_s - l.max_drive_s);
    }
    return g;
}

std::uint64_t limit_block(double* x, unsigned n, double limit) noexcept
{
    // Rounding may put a drive at the limit an ulp or two above it. Such a sample is limited, but not
    // counted.
    const double counted = limit * (1.0 + 1e-9);
    std::uint64_t changed = 0;
    for (unsigned i = 0; i < n; ++i)
        changed += std::abs(x[i]) <= counted ? 0 : 1;
    for (unsigned i = 0; i < n; ++i) {
        const double v = x[i] == x[i] ? x[i] : 0.0;
        const double low = v < limit ? v : limit;
        x[i] = low > -limit ? low : -limit;
    }
    return changed;
}

std::vector<double> channel_limits(const array& a, unsigned channels)
{
    std::vector<double> limits(channels, 0.0);
    for (const tactor_spec& t : a.tactors)
        if (t.channel < channels)
            limits[t.channel] = clamp_limit(std::pow(10.0, t.max_dbfs / 20.0));
    return limits;
}

namespace {

// Time constant of each of the two stages that smooth the gain. The gain then has no corners, and its changes
// have no content above 1 kHz.
constexpr double smooth_s = 0.002;
constexpr double release_s = 0.05;
constexpr double noise = 1e-9;

} // namespace

power_guard::power_guard(std::size_t channels, double most, double reach, unsigned rate)
    // The sum of the allowed number of full-scale channels may exceed the limit by rounding noise.
    : most_(std::isfinite(most) ? most * (1.0 + noise) : std::numeric_limits<double>::infinity()),
      on_(reach > most_),
      decay_(std::exp(-1.0 / (release_s * rate))),
      blend_(-std::expm1(-1.0 / (smooth_s * rate))),
      held_(most_),
      let_(on_ ? channels : 0),
      other_(let_)
{
}

void power_guard::step(double sum) noexcept
{
    held_ = std::max({most_, sum, held_ * decay_});
    const double target = held_ > most_ ? std::sqrt(most_ / held_) : 1.0;
    near_ += blend_ * (target - near_);
    gain_ += blend_ * (near_ - gain_);
    if (target >= 1.0 && std::min(near_, gain_) > 1.0 - noise)
        near_ = gain_ = 1.0;
}

void power_guard::admit(std::span<const powered_channel> channels, unsigned frame) noexcept
{
    for (const powered_channel& c : channels)
        let_[c.channel] = c.envelope[frame];
}

void power_guard::record_unchanged_block(std::span<const powered_channel> channels, unsigned n) noexcept
{
    std::fill(let_.begin(), let_.end(), 0.0);
    admit(channels, n - 1);
}

/// Keeps the state of the channels that sound. A channel that is silent in a block starts anew.
void power_guard::keep(std::span<const powered_channel> channels) noexcept
{
    std::fill(other_.begin(), other_.end(), 0.0);
    for (const powered_channel& c : channels)
        other_[c.channel] = let_[c.channel];
    let_.swap(other_);
}

/// Handles a sum above the headroom. Falling and constant channels keep their gain; rising channels share the
/// rest of the headroom.
void power_guard::distribute_headroom(std::span<const powered_channel> channels, unsigned frame, double sum,
                                      double headroom) noexcept
{
    double base = 0.0;
    for (const powered_channel& c : channels)
        base += std::min(let_[c.channel], c.envelope[frame]);
    const double scale = base > headroom ? headroom / base : 1.0;
    const double rise = base < headroom ? (headroom - base) / (sum - base) : 0.0;
    for (const powered_channel& c : channels) {
        const double wanted = c.envelope[frame];
        const double had = std::min(let_[c.channel], wanted);
        const double let = scale * had + rise * (wanted - had);
        let_[c.channel] = let;
        c.x[frame] *= gain_ * (let < wanted ? std::sqrt(let / wanted) : 1.0);
    }
}

std::uint64_t power_guard::apply(std::span<const powered_channel> channels, unsigned n) noexcept
{
    std::array<double, block_frames> sum{};
    for (const powered_channel& c : channels)
        for (unsigned j = 0; j < n; ++j)
            sum[j] += c.envelope[j];
    keep(channels);
    std::uint64_t changed = 0;
    bool squeezed = true; // true if let_ is that of the previous frame
    for (unsigned j = 0; j < n; ++j) {
        step(sum[j]);
        const double headroom = most_ / (gain_ * gain_);
        const bool fits = sum[j] <= headroom * (1.0 + noise);
        changed += fits && gain_ >= 1.0 ? 0 : 1;
        if (!fits) {
            if (!squeezed)
                admit(channels, j - 1);
            distribute_headroom(channels, j, sum[j], headroom);
        }
        sum[j] = fits ? gain_ : 1.0;
        squeezed = !fits;
    }
    for (const powered_channel& c : channels)
        for (unsigned j = 0; j < n; ++j)
            c.x[j] *= sum[j];
    if (!squeezed)
        admit(channels, n - 1);
    return changed;
}

void power_guard::silence(std::uint64_t frames) noexcept
{
    std::fill(let_.begin(), let_.end(), 0.0);
    for (; frames > 0 && !passes(0.0); --frames)
        step(0.0);
}

namespace {

constexpr double fade_s = 0.02;
constexpr double pause_s = 0.001; // longer than a sine stays near zero
constexpr double counted = least_counted_drive * least_counted_drive;
constexpr double rounding = 1e-6; // rounding error of a level, frames

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

void drive_guard::drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept
{
    cell& c = cells_[channel];
    const auto end = static_cast<std::int64_t>(to);
    auto at = static_cast<std::int64_t>(from);
    while (at < end) {
        if (at >= c.closed_at && at < c.opens_at) {
            at = c.opens_at; // the fade was counted when the channel was closed
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
}

void drive_guard::close(cell& c) const noexcept
{
    // A channel that still fades in has a low gain already, so less of the fade remains.
    const std::int64_t done = std::clamp<std::int64_t>(c.opens_at + fade_ - c.at, 0, fade_);
    c.closed_at = c.at - done;
    add(c, fade_ - done);
    set_opening_time(c);
}

void drive_guard::set_opening_time(cell& c) const noexcept
{
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
        return 1.0; // the channel closes later in this block
    if (k >= fade_)
        return falls ? 0.0 : 1.0;
    const double half = 0.5 * sincos_turns(0.5 * static_cast<double>(k) / static_cast<double>(fade_)).cos;
    return falls ? 0.5 + half : 0.5 - half;
}

bool drive_guard::changes_block(std::size_t channel, std::uint64_t clock, unsigned n) const noexcept
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

void drive_guard::raise(std::size_t channel, std::uint64_t clock, double level_s) noexcept
{
    if (channel >= cells_.size())
        return;
    cell& c = cells_[channel];
    const auto now = static_cast<std::int64_t>(clock);
    const bool rests = c.at < now;
    const bool closed = c.closed_at <= now && now < c.opens_at;
    rest(c, now);
    const double level = std::min(level_s * rate_, limit_);
    if (!(level > c.level))
        return;
    c.level = level;
    if (closed) {
        set_opening_time(c);
    } else if (level > limit_ - 1.0 && rests) { // the channel is silent, so nothing fades out
        c.closed_at = now - fade_;
        set_opening_time(c);
    } else if (level > limit_ - 1.0) {
        close(c);
    }
}

} // namespace tactor::synth
