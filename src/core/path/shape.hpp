// SPDX-License-Identifier: MIT
// Geometry of points, and curved pieces of a path: cubic Bezier curves and arcs of ellipses. A place on a
// curve follows from a parameter from 0 to 1 or from the arc length.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
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

struct box {
    point low;
    point high;

    /// Returns true if p is in the box or at most `margin_mm` outside it.
    bool holds(point p, double margin_mm) const noexcept
    {
        return p.x_mm >= low.x_mm - margin_mm && p.x_mm <= high.x_mm + margin_mm &&
               p.y_mm >= low.y_mm - margin_mm && p.y_mm <= high.y_mm + margin_mm;
    }
};

/// Returns the smallest box around some points (at least one).
inline box bounding_box(const std::vector<point>& points)
{
    box b{points.front(), points.front()};
    for (const point& p : points) {
        b.low = {std::min(b.low.x_mm, p.x_mm), std::min(b.low.y_mm, p.y_mm)};
        b.high = {std::max(b.high.x_mm, p.x_mm), std::max(b.high.y_mm, p.y_mm)};
    }
    return b;
}

inline double dot(point a, point b) noexcept
{
    return a.x_mm * b.x_mm + a.y_mm * b.y_mm;
}

/// Returns hypot(x, y). The result has the same bits on every machine: those of glibc 2.35 and later when it
/// does not use fused multiply-add (Borges 2019, algorithm "fused" without fused operations). Inline, because
/// a call would take as long as the rest of a phantom.
[[gnu::always_inline]] inline double portable_hypot(double x, double y) noexcept
{
    const double u = std::abs(x);
    const double v = std::abs(y);
    const double a = u < v ? v : u;
    const double b = u < v ? u : v;
    if (!(b >= 0x1p-459 && a <= 0x1p511)) // infinite numbers, and numbers whose squares lose digits
        return std::hypot(x, y);
    if (b <= a * 0x1p-54)
        return a + b;
    const double h = std::sqrt(a * a + b * b);
    const bool near = h <= 2.0 * b;
    const double d = h - (near ? b : a);
    const double first = near ? a * (2.0 * d - a) : 2.0 * d * (a - 2.0 * b);
    const double second = near ? (d - 2.0 * (a - b)) * d : (4.0 * d - b) * b + d * d;
    return h - (first + second) / (2.0 * h);
}

/// Returns the same value as tactor::distance_mm().
[[gnu::always_inline]] inline double length_mm(point a, point b) noexcept
{
    return portable_hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm);
}

/// Interpolates linearly from a (u = 0) to b (u = 1). Both ends are exact. If u is 1/2, 1/4, ..., multiplying
/// by u adds no rounding error.
inline point interpolate_points(point a, point b, double u) noexcept
{
    return u < 1.0 ? a + u * (b - a) : b;
}

struct cubic {
    std::array<point, 4> p;
};

/// The arc centre + u cos(angle) + v sin(angle), where angle = from + sweep * t in radians. The vectors u and
/// v are conjugate radii, so an affine map of an arc is an arc.
struct elliptic {
    point centre;
    point u;
    point v;
    double from = 0.0;
    double sweep = 0.0;
};

using shape = std::variant<cubic, elliptic>;

point position(const shape& c, double t) noexcept;

/// Returns the parameters inside (0, 1) at which a coordinate has an extremum, ascending. Between these
/// parameters the coordinate is monotone.
std::vector<double> find_turning_points(const shape& c, axis a);

/// Returns the corners of a convex polygon that contains a curve.
std::array<point, 4> control_frame(const shape& form);

/// Returns the parameters inside (0, 1) at which the coordinate along direction `out` has an extremum,
/// ascending.
std::vector<double> find_turns_in_direction(const shape& form, point out);

/// The map x' = a x + c y + e, y' = b x + d y + f. Its six numbers are those of SVG's matrix().
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

/// Returns the rotation about the origin, which is clockwise if y points down. Multiples of 90 degrees are
/// exact.
affine rotation(double degrees);

/// Returns the map that applies first `inner`, then `outer`.
affine operator*(const affine& outer, const affine& inner) noexcept;

shape apply_map(const shape& c, const affine& m) noexcept;

/// A table of pairs (parameter, arc length). Its entries are so close that Gauss quadrature from one entry
/// towards the next is accurate to about a nanometre, even at cusps.
class arc_length {
public:
    explicit arc_length(const shape& c);

    double total() const noexcept { return s_.back(); }
    /// Returns the arc length at a parameter from 0 to 1. `c` is the shape from which the table was made.
    double at(const shape& c, double t) const noexcept;
    /// Returns the parameter at an arc length, clamped to 0 ... 1.
    double parameter(const shape& c, double s_mm) const noexcept;

private:
    bool even_; ///< true if the parameter is proportional to the length
    std::vector<double> t_;
    std::vector<double> s_;
    std::vector<double> speed_; ///< speed at each entry; empty if the parameter is proportional to the length
};

/// Places on a curve by arc length, for strokes that need a place each millisecond. Polynomials in the arc
/// length replace the inversion of the length. Their error is less than 1e-9 mm; on curves of kilometres it
/// is a rounding error.
class curve_places {
public:
    /// Makes the polynomials. Gives up if they need more than `most` pieces: pieces() is then greater than
    /// `most`, and at() must not be called.
    curve_places(const shape& c, const arc_length& measure, std::size_t most);

    /// Returns the place at an arc length between 0 and the length of the curve.
    point at(double s_mm) const noexcept;
    std::size_t pieces() const noexcept { return pieces_.size(); }

private:
    static constexpr std::size_t nodes = 7;

    /// A polynomial in Newton's form: c[0] + (s - s[0]) (c[1] + (s - s[1]) (c[2] + ...)).
    struct piece {
        std::array<double, nodes> s;
        std::array<point, nodes> c;

        point at(double s_mm) const noexcept;
    };

    std::vector<double> ends_mm_;
    std::vector<piece> pieces_;
};

} // namespace tactor::detail
