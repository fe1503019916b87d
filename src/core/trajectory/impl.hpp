// SPDX-License-Identifier: MIT
// Contents of a trajectory.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/pace.hpp"
#include "core/path/shape.hpp"

namespace tactor::detail {

struct drawn_path {
    path way;
    double intensity;
    std::shared_ptr<const pace> moves = {}; ///< null for constant speed
};

// Points of a timed trajectory. All copies that with_duration() makes share them.
struct timed_points {
    std::shared_ptr<const std::vector<timed_point>> points;
    double length_mm;

    double duration_s() const noexcept { return points->back().t_s; }
};

/// Throw error (bad_input) for a value that no stroke can have. `what` names the value in messages.
void check_duration(double duration_s);
void check_intensity(std::string_view what, double intensity);
/// Returns the movement with every intensity multiplied by a factor. Unlike with_intensity(), this function
/// has no upper limit, because the level_db of a stroke may be above 0.
trajectory scale_intensity(const trajectory& t, double factor);

/// Adds all corners of a movement, its ends included, to `corners`, and its curves to `curves`.
void add_outline(const trajectory& t, std::vector<point>& corners, std::vector<shape>& curves);

/// Moves `from` to the origin, then maps the movement by `m`. This order keeps the precision of small
/// pictures far from the origin. If `m` maps everything to a line, `line` gives its direction, and curves
/// become straight pieces between their extrema. Times and intensities do not change. `what` names the
/// movement in messages.
/// \throws error (bad_input) for coordinates beyond the limit of a path.
trajectory map_trajectory(const trajectory& t, point from, const affine& m, std::optional<point> line,
                          std::string_view what);

/// Reverses a list of points that are placed by part of the path, for a path that is reversed.
template <class Point>
std::vector<Point> reverse_parts(std::vector<Point> points)
{
    std::reverse(points.begin(), points.end());
    for (Point& p : points)
        p.part = 1.0 - p.part;
    return points;
}

/// Returns the sound of a stroke that is played backwards. Carriers that would come before its start are
/// moved to the start.
inline stroke_sound reverse_sound(stroke_sound s, double duration_s)
{
    s.carrier_profile = reverse_parts(std::move(s.carrier_profile));
    std::reverse(s.carrier_times.begin(), s.carrier_times.end());
    for (carrier_time& p : s.carrier_times)
        p.t_s = std::max(duration_s - p.t_s, 0.0);
    return s;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

struct trajectory::impl {
    std::variant<detail::drawn_path, detail::timed_points> law;
    double duration_s = 0.0;
    double gain = 1.0;

    /// Convert a time of this trajectory to the time of its points or pace, whose duration is `own_s`, and
    /// vice versa.
    double to_own_time(double t_s, double own_s) const noexcept
    {
        return own_s == duration_s ? t_s : t_s / duration_s * own_s;
    }
    double from_own_time(double t_s, double own_s) const noexcept
    {
        return own_s == duration_s ? t_s : std::min(t_s / own_s * duration_s, duration_s);
    }

    /// Returns the time at which the target reaches an arc length of the path.
    double arrival_s(const detail::drawn_path& l, double s_mm) const noexcept
    {
        const double length = l.way.length_mm();
        return l.moves ? from_own_time(l.moves->arrival_s(s_mm / length), l.moves->total_s())
                       : s_mm / length * duration_s;
    }

    /// Timed points before and after a time, and the position of the time between these points (0 to 1).
    struct bracket {
        const timed_point* before;
        const timed_point* after;
        double part;
    };

    bracket find(const detail::timed_points& l, double t_s) const noexcept;
    std::vector<double> find_meetings(detail::axis a, double line) const;
    /// Returns the times, ascending, at which the target is at an end of a segment of its path, or at a timed
    /// point.
    std::vector<double> vertices() const;
};

} // namespace v0
} // namespace tactor
