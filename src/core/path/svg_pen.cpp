// SPDX-License-Identifier: MIT
#include "core/path/svg_pen.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>

namespace tactor::detail {
namespace {

// Returns the arc of command A: part of the ellipse with radii rx and ry (signs do not matter) whose x axis
// is turned by `turn_deg`, from point to point, the longer or the shorter way round. If the radii do not
// reach, they grow together until they do. Returns nothing for a straight line, for example with a radius of
// 0.
// https://www.w3.org/TR/SVG2/implnote.html#ArcImplementationNotes
//
// Turns the ellipse straight and stretches it to a circle with the longer radius. The computation works on
// that circle.
std::optional<elliptic> svg_arc(point from, double rx, double ry, double turn_deg, bool longer,
                                bool clockwise, point to)
{
    const double radius = std::max(std::abs(rx), std::abs(ry));
    const double kx = std::abs(rx) / radius;
    const double ky = std::abs(ry) / radius;
    const double c = boost::math::cos_pi(std::remainder(turn_deg, 360.0) / 180.0);
    const double s = boost::math::sin_pi(std::remainder(turn_deg, 360.0) / 180.0);

    // Vector from the middle of the chord to the start.
    const point half = 0.5 * (from - to);
    const point h{(c * half.x_mm + s * half.y_mm) / kx, (c * half.y_mm - s * half.x_mm) / ky};
    const double reach = std::hypot(h.x_mm, h.y_mm);
    if (!(kx > 0.0 && ky > 0.0 && reach > 0.0))
        return std::nullopt;

    // A half circle's reach equals the radius but for rounding. A root would enlarge that error to a
    // ten-millionth of the radius.
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

} // namespace

void path_pen::draw(char command, const path_arguments& v)
{
    const char kind = upper(command);
    const point base = command == kind ? point{} : at_;
    const auto to = [&](std::size_t i) { return point{base.x_mm + v[i], base.y_mm + v[i + 1]}; };
    switch (kind) {
    case 'M':
        return move(to(0));
    case 'L':
        return line(to(0));
    case 'H':
        return line({base.x_mm + v[0], at_.y_mm});
    case 'V':
        return line({at_.x_mm, base.y_mm + v[0]});
    case 'C':
        return cubic(to(0), to(2), to(4));
    case 'S':
        return cubic(cubic_handle_, to(0), to(2));
    case 'Q':
        return quadratic(to(0), to(2));
    case 'T':
        return quadratic(quadratic_handle_, to(0));
    default:
        return arc(v, to(5));
    }
}

void path_pen::move(point to)
{
    finish();
    start_ = to;
    open_.vertices.assign(1, to);
    arrive(to);
    draws_ = false;
}

void path_pen::line(point to)
{
    open_.line(to);
    arrive(to);
}

void path_pen::cubic(point c1, point c2, point to)
{
    open_.bezier(c1, c2, to);
    arrive(to);
    cubic_handle_ = to + (to - c2);
}

void path_pen::quadratic(point c, point to)
{
    open_.quadratic(c, to);
    arrive(to);
    quadratic_handle_ = to + (to - c);
}

void path_pen::arc(const path_arguments& v, point to)
{
    if (to == at_) {
        cubic_handle_ = quadratic_handle_ = to;
        return; // SVG draws no arc here, where a line would have no length
    }
    if (const auto a = svg_arc(at_, v[0], v[1], v[2], v[3] != 0.0, v[4] != 0.0, to))
        open_.arc(*a, to);
    else
        open_.line(to);
    arrive(to);
}

void path_pen::close()
{
    line(start_);
    move(start_);
}

std::vector<outline> path_pen::take()
{
    finish();
    return std::exchange(drawn_, {});
}

// Records that something was drawn, if only a point. Every command but M does.
void path_pen::arrive(point to)
{
    draws_ = true;
    at_ = cubic_handle_ = quadratic_handle_ = to;
}

void path_pen::finish()
{
    if (draws_)
        drawn_.push_back(std::move(open_));
    open_ = {};
    draws_ = false;
}

} // namespace tactor::detail
