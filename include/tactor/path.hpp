// SPDX-License-Identifier: MIT
/// \file
/// Points and curves on the skin.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// A place on the array in mm: x to the right, y down, as on a screen.
struct point {
    double x_mm = 0.0;
    double y_mm = 0.0;

    friend bool operator==(const point&, const point&) = default;
};

/// Returns the distance between two points, mm.
inline double distance_mm(point a, point b) noexcept
{
    return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm);
}

/// Two places less than this far apart count as the same place: a nanometre.
inline constexpr double same_place_mm = 1e-6;

/// An open or closed curve of lines, arcs and Bezier curves, or a single place of length 0. Immutable. Copies
/// and moves share the curve, so a moved-from path keeps its value. All members are safe to call from any
/// thread and do not block.
class TACTOR_API path {
public:
    /// Reads SVG path data in mm, e.g. "M 0 10 C 20 -5 20 45 40 30". "M 20 20" is a single place.
    /// \throws error (bad_input) for a text that is not path data (the error has the column), for numbers
    ///         that are not finite or are beyond 1e6 mm, and for more than one subpath.
    [[nodiscard]] static path from_svg(std::string_view data);

    /// Joins the points by straight lines; a single point makes a single place. Throws like from_svg(), and
    /// if `points` is empty.
    [[nodiscard]] static path polyline(std::span<const point> points);

    /// Makes a circular arc round `centre`. Angles are in degrees from the x axis towards the y axis
    /// (clockwise on a screen). `sweep_deg` is from -360 to 360. Throws like from_svg().
    [[nodiscard]] static path arc(point centre, double radius_mm, double from_deg, double sweep_deg);

    /// Returns the length in mm, accurate to 1 um.
    [[nodiscard]] double length_mm() const noexcept;

    /// Returns the point at arc length s (clamped to 0 ... length), accurate to 1 um. O(log n) for n
    /// segments.
    [[nodiscard]] point at(double s_mm) const noexcept;

    /// Returns the arc lengths, ascending, at which the path meets or touches the line x = x_mm. A stretch of
    /// the path that runs along the line (within same_place_mm) for more than 0.1 mm gives no result, not
    /// even at its ends. A shorter stretch counts as a touch.
    [[nodiscard]] std::vector<double> meets_x(double x_mm) const;
    /// Returns the same for the line y = y_mm.
    [[nodiscard]] std::vector<double> meets_y(double y_mm) const;

    /// Returns SVG path data of the curve, for plots.
    [[nodiscard]] std::string svg() const;

    path(const path&) noexcept = default; ///< also used for moves: a path always has its curve
    path& operator=(const path&) noexcept = default;

    struct impl;

private:
    friend struct detail::access;
    explicit path(std::shared_ptr<const impl> p) noexcept : impl_(std::move(p)) {}

    std::shared_ptr<const impl> impl_;
};

} // namespace v0
} // namespace tactor
