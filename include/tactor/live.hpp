// SPDX-License-Identifier: MIT
/// \file
/// Strokes that are fed point by point while they sound: from a sensor, a finger, a simulation.
#pragma once

#include <cstdint>
#include <memory>

#include <tactor/api.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

namespace tactor {

/// Number of a stroke that a player was given, unique in one player.
using stroke_id = std::uint32_t;

struct live_options {
    /// What of it counts: `method` (continuous: the carrier runs and the phantom's weights follow the
    /// points; park2016: bursts, each SOA one at the newest position), `phantom` or `custom_phantom`,
    /// `carrier_hz`, `leave`; for bursts `soa_s` and `profile`, which give their duration.
    plan_options plan{.method = algorithm::continuous, .leave = outside::clamp};
    /// Levels, phase and the bursts' ramp; rate and channels are the stream's.
    render_options render = {};
    /// A producer that gives no point for so long, s, 0.001 to 86400, has failed: the stroke fades out and
    /// ends interrupted. Counted from player::begin() on, before the first point too; in frames of the
    /// stream, so not while the system sleeps.
    double timeout_s = 0.5;
};

/// What became of the points so far.
struct live_counts {
    std::uint64_t points = 0;  ///< taken by to()
    std::uint64_t outside = 0; ///< of these, moved to the nearest point of the array
    std::uint64_t limited = 0; ///< of these, with a tactor that was held at its channel's limit
};

/// The producer's end of a live stroke. Cheap to copy; all copies feed the same stroke, and a move is a copy.
/// May outlive the player. Without end() or cancel(), or when no copy is left, the stroke ends when points no
/// longer come (live_options::timeout_s).
/// Any thread may call all members; none waits for the audio thread or the player, only (for a
/// microsecond) for another call of to() on the same stroke.
class TACTOR_API live_stroke {
public:
    stroke_id id() const noexcept;

    /// Moves the stroke to a place, mm, at an intensity (linear, 1 is the level that was asked for). Of
    /// several points between two renderings the newest counts. Continuous: the weights go from the last
    /// point's to this one's within one period (at least continuous_step_s), and do so from the next period
    /// that is written on, so that a point begins to be audible within a period and that step, and the
    /// delay of the buffer. Bursts: the next one that starts, an SOA later at most, has this place.
    /// False when the stroke has ended; its report says why.
    /// \throws error (bad_input) for what is not finite or an intensity below 0, and with outside::error for
    ///         a point outside the array; the stroke goes on where it was.
    bool to(double x_mm, double y_mm, double intensity = 1.0);

    /// No more points come: fades out (continuous), or plays its last burst to the end. It ends finished.
    void end() noexcept;
    /// Fades out; it ends cancelled. The same as player::cancel().
    void cancel() noexcept;

    /// Whether it can still be fed.
    bool open() const noexcept;
    live_counts counts() const noexcept;

    live_stroke(const live_stroke&) noexcept = default;
    live_stroke& operator=(const live_stroke&) noexcept = default;

    struct impl;
    explicit live_stroke(std::shared_ptr<impl> p); ///< for the player. \throws error (bad_input) for none

private:
    std::shared_ptr<impl> impl_;
};

} // namespace tactor
