// SPDX-License-Identifier: MIT
// A target's position on its path over time, and the time at which the target reaches a position. Both are
// closed forms.
#pragma once

#include <vector>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Returns the time, s, that a movement's speeds need for a length. Rests are not included.
double travel_time_s(const movement& m, double length_mm);

/// Checks a movement, except durations, which depend on the path.
/// \throws error (bad_input) for impossible values.
void check_movement(const movement& m);

/// A movement in its own time, for any path: seconds from 0 to total_s().
class pace {
public:
    /// Constructs a pace. Precondition: `m` passes check_movement(). `moving_s` > 0 is the time without
    /// rests.
    pace(movement m, double moving_s);

    double total_s() const noexcept { return total_s_; }
    double moving_s() const noexcept { return moving_s_; }
    const movement& definition() const noexcept { return definition_; }

    /// Returns the part of the path, 0 to 1, covered at a time. Clamps the time. O(log n).
    double part(double t_s) const noexcept;
    /// Returns the factor by which the intensity is multiplied at a time. O(log n).
    double intensity(double t_s) const noexcept;
    /// Returns the time at which the target reaches a part of the path. O(log n).
    double arrival_s(double part) const noexcept;
    /// Returns the times from 0 to total_s(), ascending, at which a rest or a stretch between two speeds
    /// begins or ends. Between two of these times part() is smooth.
    std::vector<double> bends() const;
    /// Returns an upper bound of the intensity between two parts of the path.
    double intensity_bound(double from_part, double to_part) const noexcept;

private:
    /// A part of the path between two given speeds.
    struct stretch {
        double part = 0.0;
        double width = 0.0;
        double change = 0.0; ///< change of the speed, relative to the first speed
        double begin_s = 0.0;
        double unit_s = 0.0; ///< time to cross this stretch at its first speed
    };
    /// A movement between two rests, or a rest.
    struct phase {
        double begin_s = 0.0;
        double end_s = 0.0;
        double from = 0.0; ///< part of the path at the start, 0 to 1
        double to = 0.0;
        double begin_moving_s = 0.0; ///< start time with rests and easing removed
        double end_moving_s = 0.0;
        double intensity = 1.0;

        bool rests() const noexcept { return from == to; }
    };

    void build_stretches();
    void build_phases();
    const phase& at(double t_s) const noexcept;
    double find_part_in_phase(const phase& p, double t_s) const noexcept;
    double find_part_after(double moving_s) const noexcept;
    double find_moving_time_s(double part) const noexcept;

    movement definition_;
    double moving_s_;
    double total_s_ = 0.0;
    std::vector<stretch> stretches_;
    std::vector<phase> phases_;
};

} // namespace tactor::detail
