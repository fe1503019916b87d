// SPDX-License-Identifier: MIT
/// \file
/// Strokes that a program feeds point by point while they sound: from a sensor, a finger, a simulation.
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

/// Options of a live stroke.
struct live_options {
    /// These members count: `algorithm`, `phantom` and `faces`, or `custom_phantom`, `carrier_hz`, `wave` (no
    /// recording along a length), `am`, `scale`, `outside`; for bursts also `soa_s`, and `burst_s` or
    /// `profile`, which give their duration. Algorithm continuous: the carrier runs and the phantom's weights
    /// follow the points. Algorithm park2016: each SOA has a burst at the newest position.
    plan_options plan{.algorithm = algorithm_kind::continuous, .outside = outside_kind::clamp};
    /// Levels, phase and the bursts' ramp. Rate and channels are the stream's.
    render_options render = {};
    /// Time-out, s, 0.001 to 86400. A producer that is silent for so long has failed: the stroke fades out
    /// and ends interrupted. The time counts from player::begin() on, also before the first point. It counts
    /// frames of the stream, so it stops while the system sleeps.
    double timeout_s = 0.5;
    /// Longest time that the stroke may sound, s, 0.001 to 86400, exact to a period. Then it fades out and
    /// ends interrupted. None: no limit.
    std::optional<double> longest_s = {};
    /// Window over which points are smoothed, s, 0 (off) to 1. It is for points that come in bursts, as over
    /// a network. Place and intensity are the mean of the points over the window that ends now. So the stroke
    /// moves evenly to each new point and reaches it one window after the point came. Behind points that move
    /// evenly it is late by half the window. end() waits until the stroke has reached the last point.
    double smooth_s = 0.0;
};

/// Counts of a live stroke's points.
struct live_counts {
    std::uint64_t points = 0;  ///< accepted by to()
    std::uint64_t outside = 0; ///< of these, points that were moved to the nearest point of the array
    std::uint64_t limited = 0; ///< of these, points at which a tactor was held at its channel's limit
    std::uint64_t held = 0;    ///< of these, points with an intensity above 1, which sounded as 1
};

/// The producer's end of a live stroke. Cheap to copy. All copies feed the same stroke, and a move is a copy.
/// It may outlive the player. Without end() or cancel(), or when no copy is left, the stroke ends by its
/// time-out (live_options::timeout_s). Any thread may call all members. No call waits for the audio thread or
/// the player; a call may wait (for a microsecond) for another call of to() on the same stroke.
class TACTOR_API live_stroke {
public:
    [[nodiscard]] stroke_id id() const noexcept;

    /// Moves the stroke to a place, mm, at an intensity (linear; 1 is the requested level). That level is the
    /// ceiling: an intensity above 1 sounds as 1, and live_counts::held and stroke_report::held_points count
    /// it. A place outside the array becomes the nearest one in it (outside_kind::clamp), and
    /// live_counts::outside and stroke_report::outside_points count it. When several points arrive within one
    /// period, the newest counts.
    ///
    /// Continuous: with the next period that is written, the weights begin to move from the last point's to
    /// this one's. The move takes one period, at least continuous_step_s. The buffer's delay adds to this.
    /// Bursts: the next burst has this place. It starts at most one SOA later. With live_options::smooth_s,
    /// both begin at that time to move there.
    ///
    /// `at_ns`: time of the touch, CLOCK_MONOTONIC; stroke_report::delay counts from it. None: now. It does
    /// not change when the stroke gets there.
    ///
    /// Returns false if the stroke has ended; its report says why. If the phantom model gives a tactor more
    /// than the intensity (after the intensity scale), the stroke ends interrupted.
    /// \throws error (bad_input) for a number that is not finite, an intensity or a time stamp below 0, a
    ///         point outside the array (with outside_kind::error), and a point that a custom phantom model
    ///         refuses with that error. The stroke then stays where it was. Other exceptions of such a model
    ///         pass through, too, and the stroke ends interrupted, with what() as its reason; std::bad_alloc
    ///         does not end it. error (runtime) if such a model calls this for the stroke that asks it. The
    ///         model may end or cancel that stroke, but must not wait for another thread that calls this.
    bool to(double x_mm, double y_mm, double intensity = 1.0, std::optional<std::int64_t> at_ns = {});
    /// Deleted: a time stamp is not an intensity, and seconds are not a time stamp.
    template <std::same_as<std::int64_t> T>
    bool to(double x_mm, double y_mm, T time_stamp) = delete;
    template <std::floating_point T>
    bool to(double x_mm, double y_mm, double intensity, T seconds) = delete;

    /// Announces that no more points come. The stroke fades out (continuous) or plays its last burst to the
    /// end, and ends finished.
    void end() noexcept;
    /// Fades the stroke out; it ends cancelled. The same as player::cancel().
    void cancel() noexcept;

    /// Returns true while the stroke accepts points.
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
