// SPDX-License-Identifier: MIT
/// \file
/// Strokes that are fed point by point while they sound: from a sensor, a finger, a simulation.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>

#include <tactor/api.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>
#include <tactor/report.hpp>

namespace tactor {
inline namespace v0 {

struct live_options {
    /// These members count: `algorithm` (continuous: the carrier runs and the phantom's weights follow the
    /// points; park2016: a burst each SOA, at the newest position), `phantom` and `faces`, or
    /// `custom_phantom`, `carrier_hz`, `wave` (no recording along a length), `am`, `scale`, `outside`; for
    /// bursts `soa_s`, and `burst_s` or `profile`, which give their duration.
    plan_options plan{.algorithm = algorithm_kind::continuous, .outside = outside_kind::clamp};
    /// Levels, phase and the bursts' ramp; rate and channels are the stream's.
    render_options render = {};
    /// Time-out, s, 0.001 to 86400. A producer that gives no point for so long has failed: the stroke fades
    /// out and ends interrupted. Counted from player::begin() on, before the first point too; in frames of
    /// the stream, so not while the system sleeps.
    double timeout_s = 0.5;
    /// Longest time that the stroke may sound, s, 0.001 to 86400, exact to a period. Then it fades out and
    /// ends interrupted. None: it may go on for ever.
    std::optional<double> longest_s = {};
    /// Window over which points are smoothed, s, 0 (off) to 1; for points that come in bursts, as over a
    /// network. The stroke's place and intensity are the mean of the points over the window that ends now. So
    /// the stroke moves evenly to each new point, and reaches it one window after the point came; behind
    /// points that move evenly it is late by half the window. end() waits until the last point is reached.
    double smooth_s = 0.0;
};

/// Counts of the points so far.
struct live_counts {
    std::uint64_t points = 0;  ///< taken by to()
    std::uint64_t outside = 0; ///< of these, moved to the nearest point of the array
    std::uint64_t limited = 0; ///< of these, with a tactor that was held at its channel's limit
    std::uint64_t held = 0;    ///< of these, with an intensity above 1, which sounded as 1
};

/// The producer's end of a live stroke. Cheap to copy; all copies feed the same stroke, and a move is a copy.
/// May outlive the player. Without end() or cancel(), or when no copy is left, the stroke ends by its
/// time-out (live_options::timeout_s). Any thread may call all members. None waits for the audio thread or
/// the player; a call may wait (for a microsecond) for another call of to() on the same stroke.
class TACTOR_API live_stroke {
public:
    [[nodiscard]] stroke_id id() const noexcept;

    /// Moves the stroke to a place, mm, at an intensity (linear, 1 is the level that was asked for). That
    /// level is the ceiling: an intensity above 1 sounds as 1, and live_counts::held and
    /// stroke_report::held_points count it. When several points arrive within one period, the newest counts.
    ///
    /// Continuous: the next period that is written begins to move the weights from the last point's to
    /// this one's. The move takes one period, at least continuous_step_s. The buffer's delay comes on top.
    /// Bursts: the next burst has this place. It starts one SOA later at most.
    /// With live_options::smooth_s, both begin at that time to move there.
    ///
    /// `at_ns`: when the touch was there, CLOCK_MONOTONIC; stroke_report::delay is counted from it. None:
    /// now. It has no influence on when the stroke gets there.
    ///
    /// False when the stroke has ended; its report says why. If the phantom model gives a tactor more than
    /// the intensity (as the intensity scale gives it), the stroke ends interrupted.
    /// \throws error (bad_input): a number that is not finite, an intensity or a time stamp below
    ///         0, (with outside_kind::error) a point outside the array, or one that a phantom model of
    ///         your own refuses so. The stroke then stays where it was. What else such a model throws comes
    ///         out, too, and the stroke ends interrupted, with what() as its reason; but for std::bad_alloc.
    ///         error (runtime): such a model calls this for the stroke that asks it. It may end or cancel it,
    ///         but may not wait for another thread that calls this.
    bool to(double x_mm, double y_mm, double intensity = 1.0, std::optional<std::int64_t> at_ns = {});
    /// A time stamp is no intensity, and seconds are no time stamp.
    template <std::same_as<std::int64_t> T>
    bool to(double x_mm, double y_mm, T time_stamp) = delete;
    template <std::floating_point T>
    bool to(double x_mm, double y_mm, double intensity, T seconds) = delete;

    /// No more points come: fades out (continuous), or plays its last burst to the end. It ends finished.
    void end() noexcept;
    /// Fades out; it ends cancelled. The same as player::cancel().
    void cancel() noexcept;

    /// Whether it can still be fed.
    [[nodiscard]] bool open() const noexcept;
    [[nodiscard]] live_counts counts() const noexcept;

    live_stroke(const live_stroke&) noexcept = default;
    live_stroke& operator=(const live_stroke&) noexcept = default;

    struct impl;

private:
    friend struct detail::access;
    explicit live_stroke(std::shared_ptr<impl> p) noexcept;

    std::shared_ptr<impl> impl_;
};

} // namespace v0
} // namespace tactor
