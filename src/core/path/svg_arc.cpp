// SPDX-License-Identifier: MIT
// An arc by its ends to an arc by its centre.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>

#include "core/path/svg_pen.hpp"

namespace tactor::detail {

// The ellipse is turned straight and stretched to a circle whose radius is its longer one; all between is
// done there.
std::optional<elliptic> svg_arc(point from, double rx, double ry, double turn_deg, bool longer,
                                bool clockwise, point to)
{
    const double radius = std::max(std::abs(rx), std::abs(ry));
    const double kx = std::abs(rx) / radius;
    const double ky = std::abs(ry) / radius;
    const double c = boost::math::cos_pi(std::remainder(turn_deg, 360.0) / 180.0);
    const double s = boost::math::sin_pi(std::remainder(turn_deg, 360.0) / 180.0);

    // From the middle of the chord to the start.
    const point half = 0.5 * (from - to);
    const point h{(c * half.x_mm + s * half.y_mm) / kx, (c * half.y_mm - s * half.x_mm) / ky};
    const double reach = std::hypot(h.x_mm, h.y_mm);
    if (!(kx > 0.0 && ky > 0.0 && reach > 0.0))
        return std::nullopt;

    // A half circle's reach is the radius but for rounding, of which a root would make a ten-millionth of it.
    constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
    const bool half_turn = reach >= radius * (1.0 - rounding);
    const double r = half_turn ? reach : radius;
    const double away = half_turn ? 0.0 : std::sqrt((r - reach) * (r + reach));
    const double side = longer != clockwise ? away / reach : -away / reach;
    const point centre{side * h.y_mm, -side * h.x_mm};

    const double short_way = 2.0 * std::atan2(reach, away);
    const double way = longer ? 2.0 * std::numbers::pi - short_way : short_way;
    const point u{r * kx * c, r * kx * s};
    const point v{-r * ky * s, r * ky * c};
    return elliptic{0.5 * (from + to) + (centre.x_mm / r) * u + (centre.y_mm / r) * v, u, v,
                    std::atan2(h.y_mm - centre.y_mm, h.x_mm - centre.x_mm), clockwise ? way : -way};
}

} // namespace tactor::detail
