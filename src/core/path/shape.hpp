// SPDX-License-Identifier: MIT
// Curved pieces of a path: cubic Bezier curves and arcs of ellipses, by a parameter from 0 to 1.
#pragma once

#include <array>
#include <variant>
#include <vector>

#include <tactor/path.hpp>

namespace tactor::detail {

enum class axis { x, y };

inline double coordinate(point p, axis a) noexcept
{
    return a == axis::x ? p.x_mm : p.y_mm;
}

inline point operator+(point a, point b) noexcept
{
    return {a.x_mm + b.x_mm, a.y_mm + b.y_mm};
}

inline point operator-(point a, point b) noexcept
{
    return {a.x_mm - b.x_mm, a.y_mm - b.y_mm};
}

inline point operator*(double k, point a) noexcept
{
    return {k * a.x_mm, k * a.y_mm};
}

inline double dot(point a, point b) noexcept
{
    return a.x_mm * b.x_mm + a.y_mm * b.y_mm;
}

/// Interpolates from a to b. Exact at both ends and, for a whole binary fraction u, in between.
inline point between(point a, point b, double u) noexcept
{
    return u < 1.0 ? a + u * (b - a) : b;
}

struct cubic {
    std::array<point, 4> p;
};

/// The arc centre + u cos(angle) + v sin(angle), angle = from + sweep * t in radians. u and v are conjugate
/// radii, so an affine map of an arc is an arc.
struct elliptic {
    point centre;
    point u;
    point v;
    double from = 0.0;
    double sweep = 0.0;
};

using shape = std::variant<cubic, elliptic>;

point position(const shape& c, double t) noexcept;

/// Returns the length of the derivative, mm per unit of t.
double speed(const shape& c, double t) noexcept;

/// Speed at t, and its derivative there.
struct speed_change {
    double speed = 0.0;
    double rate = 0.0; ///< NaN if the speed is 0
};
speed_change speed_and_rate(const shape& c, double t) noexcept;

/// Returns the length from one parameter to another, by Gauss-Legendre quadrature on fifteen nodes.
double length_between(const shape& c, double from, double to) noexcept;

/// Returns true if the speed is constant but for rounding, as on an arc of a circle.
bool is_even(const shape& c) noexcept;

/// Returns the parameters inside (0, 1) at which a coordinate turns; ascending. Between them it is monotone.
std::vector<double> turns(const shape& c, axis a);

/// Returns the corners of a convex figure round a curve.
std::array<point, 4> control_frame(const shape& form);

/// Returns the parameters inside (0, 1) at which a curve turns round as seen in a direction; ascending.
std::vector<double> turns_towards(const shape& form, point out);

/// Returns the parameters inside (0, 1) at which the speed is least or greatest, cusps included; ascending.
std::vector<double> speed_turns(const shape& c);

/// Returns an upper bound of the length, for tolerances.
double rough_length(const shape& c) noexcept;

/// The map x' = a x + c y + e, y' = b x + d y + f: the six numbers of SVG's matrix().
struct affine {
    double a = 1.0;
    double b = 0.0;
    double c = 0.0;
    double d = 1.0;
    double e = 0.0;
    double f = 0.0;

    point operator()(point p) const noexcept
    {
        return {a * p.x_mm + c * p.y_mm + e, b * p.x_mm + d * p.y_mm + f};
    }
    double determinant() const noexcept { return a * d - b * c; }
};

inline affine translation(point by) noexcept
{
    return {1.0, 0.0, 0.0, 1.0, by.x_mm, by.y_mm};
}

/// Returns the turn about the origin, clockwise where y points down; exact for quarter turns.
affine rotation(double degrees);

/// Returns the map that applies `inner` first, then `outer`.
affine operator*(const affine& outer, const affine& inner) noexcept;

shape mapped(const shape& c, const affine& m) noexcept;

} // namespace tactor::detail
