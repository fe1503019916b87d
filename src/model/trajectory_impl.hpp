// SPDX-License-Identifier: MIT
// What is inside a trajectory.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include <tactor/stroke.hpp>

#include "model/path_shape.hpp"

namespace tactor {

namespace detail {

struct constant_speed {
    path way;
    double intensity;
};

// Shared by all that with_duration() makes of it.
struct timed_points {
    std::shared_ptr<const std::vector<timed_point>> points;
    double length_mm;

    double duration_s() const noexcept { return points->back().t_s; }
};

} // namespace detail

struct trajectory::impl {
    std::variant<detail::constant_speed, detail::timed_points> law;
    double duration_s = 0.0;
    double gain = 1.0;

    /// Time of a timed law at time t of this trajectory.
    double own_time(const detail::timed_points& l, double t_s) const noexcept
    {
        const double own = l.duration_s();
        return own == duration_s ? t_s : t_s / duration_s * own;
    }

    /// The points before and after a time, and how far it is from one to the other (0 to 1).
    struct bracket {
        const timed_point* before;
        const timed_point* after;
        double part;
    };

    bracket find(const detail::timed_points& l, double t_s) const noexcept;
    std::vector<double> meets(detail::axis a, double line) const;
};

} // namespace tactor
