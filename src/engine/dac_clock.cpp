// SPDX-License-Identifier: MIT
#include "engine/dac_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactor::engine {
namespace {

constexpr double reading_error_ns = 0.5e6; // standard deviation
constexpr double first_drift = 1e-3;       // crystals drift by 100 ppm at most, virtual sound cards by more
// Growth of the drift's variance while a crystal warms up: the standard deviation is 0.01 ppm after a second.
constexpr double drift_walk_per_ns = 1e-8 * 1e-8 * 1e-9;
constexpr double gate = 4.0; // standard deviations
constexpr unsigned give_up_after = 8;
constexpr double far = 9e18; // range of int64

double square(double x) noexcept
{
    return x * x;
}

double frames_between(std::uint64_t from, std::uint64_t to) noexcept
{
    return to >= from ? static_cast<double>(to - from) : -static_cast<double>(from - to);
}

// Returns to - from in ns. Exact while both times are below 2^53 ns (104 days), within 8 ns while they are
// below two years.
double ns_between(std::int64_t from, std::int64_t to) noexcept
{
    return static_cast<double>(to) - static_cast<double>(from);
}

std::int64_t later(std::int64_t t, double ns) noexcept
{
    std::int64_t sum = 0;
    if (__builtin_add_overflow(t, std::llround(std::clamp(ns, -far, far)), &sum))
        return ns > 0.0 ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
    return sum;
}

} // namespace

std::int64_t clock_line::time_at(std::uint64_t stream_frame) const noexcept
{
    return later(time_ns, frames_between(frame, stream_frame) * ns_per_frame);
}

std::uint64_t clock_line::frame_at(std::int64_t time) const noexcept
{
    const double frames = std::clamp(ns_between(time_ns, time) / ns_per_frame, -far, far);
    const auto n = std::llround(frames);
    if (n < 0)
        return frame - std::min(frame, std::uint64_t{0} - static_cast<std::uint64_t>(n));
    return frame + static_cast<std::uint64_t>(n);
}

dac_clock::dac_clock(unsigned rate, unsigned batch_frames) noexcept
    : nominal_(1e9 / std::max(rate, 1U)),
      // A position that moves by whole periods is off by up to one period.
      noise_(square(std::max(reading_error_ns, 0.25 * batch_frames * nominal_)))
{
}

void dac_clock::begin_epoch(std::uint64_t first) noexcept
{
    const std::uint64_t epoch = line_.epoch + 1;
    line_ = {};
    line_.epoch = epoch;
    line_.first = first;
    line_.frame = first;
    in_a_row_ = 0;
}

void dac_clock::begin_line(std::int64_t time_ns, std::uint64_t frame) noexcept
{
    line_.frame = frame;
    line_.time_ns = time_ns;
    line_.ns_per_frame = nominal_;
    fraction_ = 0.0;
    drift_ = 0.0;
    p_time_ = noise_;
    p_cross_ = 0.0;
    p_drift_ = square(first_drift);
    in_a_row_ = 0;
}

void dac_clock::add(std::int64_t time_ns, std::uint64_t frame) noexcept
{
    if (frame <= line_.frame)
        return;
    if (!line_.valid())
        return begin_line(time_ns, frame);
    const double dt = frames_between(line_.frame, frame) * nominal_;
    const double step = dt * (1.0 + drift_);
    const double p_time = p_time_ + dt * (2.0 * p_cross_ + dt * p_drift_);
    const double p_cross = p_cross_ + dt * p_drift_;
    const double p_drift = p_drift_ + dt * drift_walk_per_ns;
    const double off = ns_between(line_.time_ns, time_ns) - (fraction_ + step);
    const double variance = p_time + noise_;
    if (std::abs(off) > gate * std::sqrt(variance)) {
        if (++in_a_row_ >= give_up_after)
            begin_line(time_ns, frame); // the system slept, or the device has another clock now
        return;
    }
    in_a_row_ = 0;
    const double gain_time = p_time / variance;
    const double gain_drift = p_cross / variance;
    const double move = fraction_ + step + gain_time * off;
    const double whole = std::floor(move);
    drift_ += gain_drift * off;
    p_time_ = (1.0 - gain_time) * p_time;
    p_cross_ = (1.0 - gain_time) * p_cross;
    p_drift_ = p_drift - gain_drift * p_cross;
    line_.frame = frame;
    line_.time_ns = later(line_.time_ns, whole);
    fraction_ = move - whole;
    line_.ns_per_frame = nominal_ * (1.0 + drift_);
}

} // namespace tactor::engine
