// SPDX-License-Identifier: MIT
#include "core/path/shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <boost/math/tools/roots.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include "core/distance.hpp"

namespace tactor::detail {
namespace {

double length(point p) noexcept
{
    return portable_hypot(p.x_mm, p.y_mm);
}

point position_on(const cubic& c, double t) noexcept
{
    const double r = 1.0 - t;
    const auto& p = c.p;
    return r * r * r * p[0] + 3.0 * r * r * t * p[1] + 3.0 * r * t * t * p[2] + t * t * t * p[3];
}

point position_on(const elliptic& c, double t) noexcept
{
    const double angle = c.from + c.sweep * t;
    return c.centre + std::cos(angle) * c.u + std::sin(angle) * c.v;
}

point derivative(const cubic& c, double t) noexcept
{
    const double r = 1.0 - t;
    const auto& p = c.p;
    return 3.0 * r * r * (p[1] - p[0]) + 6.0 * r * t * (p[2] - p[1]) + 3.0 * t * t * (p[3] - p[2]);
}

point derivative(const elliptic& c, double t) noexcept
{
    const double angle = c.from + c.sweep * t;
    return c.sweep * (std::cos(angle) * c.v - std::sin(angle) * c.u);
}

point second_derivative(const cubic& c, double t) noexcept
{
    const auto& p = c.p;
    return 6.0 * (1.0 - t) * (p[2] - 2.0 * p[1] + p[0]) + 6.0 * t * (p[3] - 2.0 * p[2] + p[1]);
}

point second_derivative(const elliptic& c, double t) noexcept
{
    const double angle = c.from + c.sweep * t;
    return -c.sweep * c.sweep * (std::cos(angle) * c.u + std::sin(angle) * c.v);
}

std::vector<double> find_turns(const cubic& c, axis a)
{
    const double d0 = coordinate(c.p[1] - c.p[0], a);
    const double d1 = coordinate(c.p[2] - c.p[1], a);
    const double d2 = coordinate(c.p[3] - c.p[2], a);
    const auto [t0, t1] = boost::math::tools::quadratic_roots(d0 - 2.0 * d1 + d2, 2.0 * (d1 - d0), d0);
    return {t0, t1};
}

// Returns the parameters at which the angle is `first` plus a multiple of `period`.
std::vector<double> at_angles(const elliptic& c, double first, double period)
{
    const double low = std::min(c.from, c.from + c.sweep);
    const double high = std::max(c.from, c.from + c.sweep);
    std::vector<double> t;
    for (double k = std::ceil((low - first) / period);; k += 1.0) {
        const double angle = first + k * period;
        if (!(angle < high))
            return t;
        t.push_back((angle - c.from) / c.sweep);
    }
}

std::vector<double> find_turns(const elliptic& c, axis a)
{
    return at_angles(c, std::atan2(coordinate(c.v, a), coordinate(c.u, a)), std::numbers::pi);
}

// Returns the roots of f . s, where f is the first derivative and s the second: a cubic with these Bernstein
// coefficients. It is monotone between the roots of its derivative.
std::vector<double> find_speed_turns(const cubic& c)
{
    const std::array f{c.p[1] - c.p[0], c.p[2] - c.p[1], c.p[3] - c.p[2]};
    const std::array s{f[1] - f[0], f[2] - f[1]};
    const std::array b{dot(f[0], s[0]), (2.0 * dot(f[1], s[0]) + dot(f[0], s[1])) / 3.0,
                       (dot(f[2], s[0]) + 2.0 * dot(f[1], s[1])) / 3.0, dot(f[2], s[1])};
    const auto value = [&b](double t) {
        const double r = 1.0 - t;
        return r * r * r * b[0] + 3.0 * r * r * t * b[1] + 3.0 * r * t * t * b[2] + t * t * t * b[3];
    };
    const std::array d{b[1] - b[0], b[2] - b[1], b[3] - b[2]};
    const auto [t0, t1] =
        boost::math::tools::quadratic_roots(d[0] - 2.0 * d[1] + d[2], 2.0 * (d[1] - d[0]), d[0]);
    std::vector<double> ends{0.0};
    for (const double t : {std::min(t0, t1), std::max(t0, t1)})
        if (t > ends.back() && t < 1.0)
            ends.push_back(t);
    ends.push_back(1.0);
    std::vector<double> roots;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const double low = value(ends[i]);
        const double high = value(ends[i + 1]);
        std::uintmax_t steps = 100;
        if ((low < 0.0 && high > 0.0) || (low > 0.0 && high < 0.0)) {
            const auto [a, z] = boost::math::tools::toms748_solve(
                value, ends[i], ends[i + 1], low, high, boost::math::tools::eps_tolerance<double>(52), steps);
            roots.push_back(0.5 * (a + z));
        } else if (low == 0.0) {
            roots.push_back(ends[i]);
        }
    }
    return roots;
}

// Uses |derivative|^2 = |u|^2 sin^2 + |v|^2 cos^2 - u . v sin 2 angle.
std::vector<double> find_speed_turns(const elliptic& c)
{
    return at_angles(c, 0.5 * std::atan2(2.0 * dot(c.u, c.v), dot(c.u, c.u) - dot(c.v, c.v)),
                     0.5 * std::numbers::pi);
}

std::vector<double> inside(std::vector<double> t)
{
    std::erase_if(t, [](double v) { return !(v > 0.0 && v < 1.0); });
    std::sort(t.begin(), t.end());
    return t;
}

cubic mapped_shape(const cubic& c, const affine& m) noexcept
{
    return {{m(c.p[0]), m(c.p[1]), m(c.p[2]), m(c.p[3])}};
}

elliptic mapped_shape(const elliptic& c, const affine& m) noexcept
{
    const point origin = m({0.0, 0.0});
    return {m(c.centre), m(c.u) - origin, m(c.v) - origin, c.from, c.sweep};
}

} // namespace

point position(const shape& c, double t) noexcept
{
    // Avoids std::visit, which is a call: a continuous stroke comes here each millisecond.
    const auto* e = std::get_if<elliptic>(&c);
    return e != nullptr ? position_on(*e, t) : position_on(*std::get_if<cubic>(&c), t);
}

double speed(const shape& c, double t) noexcept
{
    return length(std::visit([t](const auto& s) { return derivative(s, t); }, c));
}

speed_change speed_and_rate(const shape& c, double t) noexcept
{
    return std::visit(
        [t](const auto& s) {
            const point first = derivative(s, t);
            const double v = length(first);
            return speed_change{v, dot(first, second_derivative(s, t)) / v};
        },
        c);
}

double length_between(const shape& c, double from, double to) noexcept
{
    return std::visit(
        [from, to](const auto& s) {
            return boost::math::quadrature::gauss<double, 15>::integrate(
                [&s](double t) {
                    // Not hypot: these lengths are far from overflow, and this line runs most often.
                    const point d = derivative(s, t);
                    return std::sqrt(dot(d, d));
                },
                from, to);
        },
        c);
}

bool is_even(const shape& c) noexcept
{
    const auto* e = std::get_if<elliptic>(&c);
    if (e == nullptr)
        return false;
    constexpr double rounding = 1e-14;
    const double u = dot(e->u, e->u);
    return std::abs(dot(e->v, e->v) - u) <= rounding * u && std::abs(dot(e->u, e->v)) <= rounding * u;
}

std::vector<double> turns(const shape& c, axis a)
{
    return inside(std::visit([a](const auto& s) { return find_turns(s, a); }, c));
}

std::array<point, 4> control_frame(const shape& form)
{
    if (const auto* b = std::get_if<cubic>(&form))
        return b->p;
    const auto& e = *std::get_if<elliptic>(&form);
    return {e.centre - e.u - e.v, e.centre - e.u + e.v, e.centre + e.u - e.v, e.centre + e.u + e.v};
}

std::vector<double> turns_towards(const shape& form, point out)
{
    const affine outwards_is_x{out.x_mm, -out.y_mm, out.y_mm, out.x_mm, 0.0, 0.0};
    return turns(mapped(form, outwards_is_x), axis::x);
}

std::vector<double> speed_turns(const shape& c)
{
    return inside(std::visit([](const auto& s) { return find_speed_turns(s); }, c));
}

double rough_length(const shape& c) noexcept
{
    if (const auto* b = std::get_if<cubic>(&c))
        return distance_mm(b->p[0], b->p[1]) + distance_mm(b->p[1], b->p[2]) + distance_mm(b->p[2], b->p[3]);
    const auto& e = *std::get_if<elliptic>(&c);
    return std::abs(e.sweep) * (distance_mm({}, e.u) + distance_mm({}, e.v));
}

affine rotation(double degrees)
{
    const double c = boost::math::cos_pi(degrees / 180.0);
    const double s = boost::math::sin_pi(degrees / 180.0);
    return {c, s, -s, c, 0.0, 0.0};
}

affine operator*(const affine& outer, const affine& inner) noexcept
{
    const point origin = outer({inner.e, inner.f});
    return {outer.a * inner.a + outer.c * inner.b,
            outer.b * inner.a + outer.d * inner.b,
            outer.a * inner.c + outer.c * inner.d,
            outer.b * inner.c + outer.d * inner.d,
            origin.x_mm,
            origin.y_mm};
}

shape mapped(const shape& c, const affine& m) noexcept
{
    return std::visit([&m](const auto& s) { return shape(mapped_shape(s, m)); }, c);
}

} // namespace tactor::detail
