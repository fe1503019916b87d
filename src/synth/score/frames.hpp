// SPDX-License-Identifier: MIT
/// \file
/// Conversion of seconds to frames (rendering model, section 7).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <tactor/plan.hpp>
#include <tactor/render.hpp>

namespace tactor::synth {

/// Ramp of bursts that do not begin and end on a zero crossing.
inline constexpr double default_ramp_s = 0.002;
/// Distance from a zero crossing, in half cycles, up to which a time counts as on it.
inline constexpr double half_cycle_tolerance = 0.01;
/// Maximum length of a drive in one event. A longer drive is split into events without a seam.
inline constexpr std::uint64_t longest_event = std::uint64_t{1} << 30;

/// Returns the nearest frame. Rounds up a tie, and also a time that misses a tie only by rounding noise:
/// otherwise the end o_k + d of a burst and the onset o_(k+1) of the next, equal on paper, could get two
/// frames.
inline std::uint64_t frame_at(double seconds, double rate) noexcept
{
    return static_cast<std::uint64_t>(std::floor(seconds * rate + 0.5 + 1e-6));
}

/// Returns true if a carrier crosses zero at both ends of a burst; `from` and `to` are in half cycles.
inline bool is_between_zeros(double from, double to) noexcept
{
    const auto on_zero = [](double at) { return std::abs(at - std::round(at)) <= half_cycle_tolerance; };
    return on_zero(from) && on_zero(to) && to - from >= 1.0 - half_cycle_tolerance;
}

/// Returns the requested ramp, or the default ramp of a burst if none is requested. The carrier has run for
/// `carrier_s` when the burst begins. Both times are exact, not rounded to whole frames.
inline double ramp_seconds(std::optional<double> ramp_s, double carrier_s, double duration_s,
                           double carrier_hz) noexcept
{
    if (ramp_s)
        return *ramp_s;
    const bool smooth =
        is_between_zeros(2.0 * carrier_s * carrier_hz, 2.0 * (carrier_s + duration_s) * carrier_hz);
    return smooth ? 0.0 : default_ramp_s;
}

/// Returns the rise time, s, of a burst or a continuous stroke whose envelope has no attack.
double plain_ramp_s(double onset_s, double duration_s, const plan& p, const render_options& o) noexcept;

/// Returns the length of the raised cosine at each end of a burst of `length` frames: at most half of the
/// burst.
inline std::uint32_t ramp_frames(double ramp_s, double rate, std::uint64_t length) noexcept
{
    return static_cast<std::uint32_t>(std::min({frame_at(ramp_s, rate), length / 2, longest_event}));
}

/// Checks an envelope. \throws error (bad_input).
void check_envelope(const burst_envelope& e);

/// Returns the number of frames in which a burst of `length` frames rises. `ramp_s` applies if its envelope
/// has no attack. Attack and release that do not fit are shortened in the same ratio.
inline std::uint32_t attack_frames(double ramp_s, const burst_envelope& e, double rate,
                                   std::uint64_t length) noexcept
{
    if (e.kind == envelope_kind::tukey)
        return ramp_frames(0.5 * e.tukey_part * static_cast<double>(length) / rate, rate, length);
    if (!e.release_s)
        return ramp_frames(e.attack_s.value_or(ramp_s), rate, length);
    const std::uint64_t rise = frame_at(e.attack_s.value_or(ramp_s), rate);
    const std::uint64_t fall = frame_at(*e.release_s, rate);
    const double fits = static_cast<double>(length) / static_cast<double>(std::max(rise + fall, length));
    return static_cast<std::uint32_t>(
        std::min(static_cast<std::uint64_t>(static_cast<double>(rise) * (rise + fall > length ? fits : 1.0)),
                 longest_event));
}

/// Returns the number of frames in which the burst falls.
inline std::uint32_t release_frames(const burst_envelope& e, double rate, std::uint64_t length,
                                    std::uint32_t attack) noexcept
{
    if (e.kind == envelope_kind::tukey || !e.release_s)
        return attack;
    return static_cast<std::uint32_t>(
        std::min({frame_at(*e.release_s, rate), length - attack, longest_event}));
}

} // namespace tactor::synth
