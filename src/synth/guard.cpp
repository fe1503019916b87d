// SPDX-License-Identifier: MIT
#include "synth/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "synth/sincos.hpp"

namespace tactor::synth {
namespace {

constexpr double release_s = 0.05;
constexpr double fade_s = 0.02;

} // namespace

power_guard::power_guard(double most, unsigned rate) noexcept
    // As many full-scale channels as allowed may miss the limit by the noise of rounding.
    : most_(std::isfinite(most) ? most * (1.0 + 1e-9) : std::numeric_limits<double>::infinity()),
      decay_(std::exp(-1.0 / (release_s * rate))),
      held_(most_)
{
}

std::uint64_t power_guard::apply(std::span<double* const> channels, unsigned n) noexcept
{
    std::array<double, block_frames> sum{};
    for (const double* x : channels) {
        for (unsigned j = 0; j < n; ++j) {
            sum[j] += x[j] * x[j];
        }
    }
    std::uint64_t changed = 0;
    for (unsigned j = 0; j < n; ++j) {
        held_ = std::max({most_, sum[j], held_ * decay_});
        changed += held_ > most_ ? 1 : 0;
        sum[j] = held_ > most_ ? std::sqrt(most_ / held_) : 1.0;
    }
    if (changed == 0) {
        return 0;
    }
    for (double* x : channels) {
        for (unsigned j = 0; j < n; ++j) {
            x[j] *= sum[j];
        }
    }
    return changed;
}

void power_guard::silence(std::uint64_t frames) noexcept
{
    for (; frames > 0 && held_ > most_; --frames) {
        held_ = std::max(most_, held_ * decay_);
    }
}

drive_guard::drive_guard(std::size_t channels, std::uint64_t limit, std::uint64_t window, unsigned rate)
    : limit_(limit),
      slot_(std::max<std::uint64_t>(1, window / slots)),
      fade_(static_cast<std::int64_t>(
          std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::lround(fade_s * rate)), 1, slot_))),
      cells_(limit > 0 && limit < window ? channels : 0)
{
    for (cell& c : cells_) {
        c.changed_at = -fade_;
    }
}

void drive_guard::turn_to(cell& c, std::uint64_t slot) noexcept
{
    while (c.slot < slot) {
        if (c.sum == 0 && !c.closed) {
            c.slot = slot; // all are empty
            return;
        }
        ++c.slot;
        std::uint32_t& oldest = c.driven[c.slot % slots];
        c.sum -= oldest;
        oldest = 0;
        if (c.closed && c.sum <= limit_ / 2) {
            c.closed = false;
            c.changed_at = static_cast<std::int64_t>(c.slot * slot_);
        }
    }
}

void drive_guard::drive(std::size_t channel, std::uint64_t from, std::uint64_t to) noexcept
{
    cell& c = cells_[channel];
    turn_to(c, from / slot_);
    from = std::max(from, c.covered);
    if (from >= to || c.closed) {
        return;
    }
    c.covered = to;
    const std::uint64_t counted = std::min(to - from, limit_ - c.sum);
    c.driven[c.slot % slots] += static_cast<std::uint32_t>(counted);
    c.sum += counted;
    if (counted < to - from) {
        c.closed = true;
        c.changed_at = static_cast<std::int64_t>(from + counted);
        ++cuts_;
    }
}

double drive_guard::gain(const cell& c, std::int64_t at) const noexcept
{
    const std::int64_t k = at - c.changed_at;
    if (k < 0) {
        return 1.0; // it will be cut later in this block
    }
    if (k >= fade_) {
        return c.closed ? 0.0 : 1.0;
    }
    const double half = 0.5 * sincos_cycles(0.5 * static_cast<double>(k) / static_cast<double>(fade_)).cos;
    return c.closed ? 0.5 + half : 0.5 - half;
}

bool drive_guard::acts(std::size_t channel, std::uint64_t clock) noexcept
{
    cell& c = cells_[channel];
    turn_to(c, clock / slot_);
    return c.closed || static_cast<std::int64_t>(clock) < c.changed_at + fade_;
}

void drive_guard::apply(std::size_t channel, std::uint64_t clock, unsigned n, double* x) const noexcept
{
    const cell& c = cells_[channel];
    const auto first = static_cast<std::int64_t>(clock);
    if (first >= c.changed_at + fade_) {
        std::fill_n(x, n, 0.0);
        return;
    }
    for (unsigned j = 0; j < n; ++j) {
        x[j] *= gain(c, first + j);
    }
}

guard_settings guards_of(const drive_limits& l, unsigned rate)
{
    check_limits(l);
    const auto frames = [rate](double s) { return static_cast<std::uint64_t>(std::llround(s * rate)); };
    guard_settings g;
    g.rate = rate;
    g.power = std::pow(10.0, l.power_dbfs / 10.0);
    if (l.max_drive_s < l.window_s) {
        g.drive_frames = frames(l.max_drive_s);
        g.window_frames = frames(l.window_s);
    }
    return g;
}

void check_limits(const drive_limits& l)
{
    if (std::isnan(l.power_dbfs) || l.power_dbfs < -120.0) {
        throw error(errc::bad_input, "power limit", fmt::format("{} dBFS is not one", l.power_dbfs),
                    "give e.g. 4.77, three channels at full scale");
    }
    if (!(l.max_drive_s >= 0.1) || !(l.window_s >= 0.1 && l.window_s <= 3600.0)) {
        throw error(errc::bad_input, "longest drive",
                    fmt::format("{} s within {} s is not a limit", l.max_drive_s, l.window_s),
                    "give 0.1 s or more within 0.1 to 3600 s, e.g. 5 within 10");
    }
}

} // namespace tactor::synth
