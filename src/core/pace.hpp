// SPDX-License-Identifier: MIT
// Position of a target on its path over time, and the time at which it reaches a part of the path. Both are
// closed forms.
#pragma once

#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Returns the time that a length takes at the speeds of a movement, s, without rests.
double time_at_speeds_s(const movement& m, double length_mm);

/// Checks a movement, except durations, which depend on the path.
/// \throws error (bad_input) for impossible values.
void check_movement(const movement& m);

/// A movement in its own time, for any path: seconds from 0 to total_s().
class pace {
public:
    /// Takes a movement that passes check_movement(), with `moving_s` > 0 between its rests.
    pace(movement m, double moving_s);

    double total_s() const noexcept { return total_s_; }
    double moving_s() const noexcept { return moving_s_; }
    const movement& definition() const noexcept { return definition_; }

    /// Returns the part of the path at a time, clamped. O(log n).
    double part(double t_s) const noexcept;
    /// Returns the factor on the intensity at a time. O(log n).
    double intensity(double t_s) const noexcept;
    /// Returns the time at which the target reaches a part of the path. O(log n).
    double arrival_s(double part) const noexcept;
    /// Returns the times at which a rest or a stretch between two speeds begins or ends, from 0 to total_s(),
    /// ascending. Between two of these times part() is smooth.
    std::vector<double> bends() const;
    /// Returns an upper bound of the intensity from one part to another.
    double greatest(double from_part, double to_part) const noexcept;

private:
    /// Part of the path between two speeds.
    struct stretch {
        double part = 0.0;
        double width = 0.0;
        double change = 0.0; ///< change of the speed, relative to its first
        double begin_s = 0.0;
        double unit_s = 0.0; ///< time to cross it at its first speed
    };
    /// Movement from rest to rest, or a rest.
    struct phase {
        double begin_s = 0.0;
        double end_s = 0.0;
        double from = 0.0; ///< part of the path
        double to = 0.0;
        double begin_moving_s = 0.0; ///< without rests and easing
        double end_moving_s = 0.0;
        double intensity = 1.0;

        bool rests() const noexcept { return from == to; }
    };

    void lay_stretches();
    void lay_phases();
    const phase& at(double t_s) const noexcept;
    double part_within(const phase& p, double t_s) const noexcept;
    double part_after(double moving_s) const noexcept;
    double moving_until(double part) const noexcept;

    movement definition_;
    double moving_s_;
    double total_s_ = 0.0;
    std::vector<stretch> stretches_;
    std::vector<phase> phases_;
};

} // namespace tactor::detail
