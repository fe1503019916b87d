// SPDX-License-Identifier: MIT
#include "core/path/shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <boost/math/tools/roots.hpp>
#include <boost/math/tools/toms748_solve.hpp>

namespace tactor::detail {
namespace {

double length(point p) noexcept
{
    return portable_hypot(p.x_mm, p.y_mm);
}

point evaluate_curve(const cubic& c, double t) noexcept
{
    const double r = 1.0 - t;
    const auto& p = c.p;
    return r * r * r * p[0] + 3.0 * r * r * t * p[1] + 3.0 * r * t * t * p[2] + t * t * t * p[3];
}

point evaluate_curve(const elliptic& c, double t) noexcept
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

// Returns the parameters at which the arc's angle equals `first` plus a multiple of `period`.
std::vector<double> find_angle_parameters(const elliptic& c, double first, double period)
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
    return find_angle_parameters(c, std::atan2(coordinate(c.v, a), coordinate(c.u, a)), std::numbers::pi);
}

// Returns the parameters at which f . s is 0, where f is the first derivative and s the second. f . s is a
// cubic with the Bernstein coefficients b. It is monotone between the roots of its derivative.
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
    return find_angle_parameters(c, 0.5 * std::atan2(2.0 * dot(c.u, c.v), dot(c.u, c.u) - dot(c.v, c.v)),
                                 0.5 * std::numbers::pi);
}

std::vector<double> keep_inner_parameters(std::vector<double> t)
{
    std::erase_if(t, [](double v) { return !(v > 0.0 && v < 1.0); });
    std::sort(t.begin(), t.end());
    return t;
}

cubic map_shape(const cubic& c, const affine& m) noexcept
{
    return {{m(c.p[0]), m(c.p[1]), m(c.p[2]), m(c.p[3])}};
}

elliptic map_shape(const elliptic& c, const affine& m) noexcept
{
    const point origin = m({0.0, 0.0});
    return {m(c.centre), m(c.u) - origin, m(c.v) - origin, c.from, c.sweep};
}

} // namespace

point position(const shape& c, double t) noexcept
{
    // Does not use std::visit, which is a function call: a continuous stroke calls this each millisecond.
    const auto* e = std::get_if<elliptic>(&c);
    return e != nullptr ? evaluate_curve(*e, t) : evaluate_curve(*std::get_if<cubic>(&c), t);
}

std::vector<double> find_turning_points(const shape& c, axis a)
{
    return keep_inner_parameters(std::visit([a](const auto& s) { return find_turns(s, a); }, c));
}

std::array<point, 4> control_frame(const shape& form)
{
    if (const auto* b = std::get_if<cubic>(&form))
        return b->p;
    const auto& e = *std::get_if<elliptic>(&form);
    return {e.centre - e.u - e.v, e.centre - e.u + e.v, e.centre + e.u - e.v, e.centre + e.u + e.v};
}

std::vector<double> find_turns_in_direction(const shape& form, point out)
{
    const affine outwards_is_x{out.x_mm, -out.y_mm, out.y_mm, out.x_mm, 0.0, 0.0};
    return find_turning_points(apply_map(form, outwards_is_x), axis::x);
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

shape apply_map(const shape& c, const affine& m) noexcept
{
    return std::visit([&m](const auto& s) { return shape(map_shape(s, m)); }, c);
}

namespace {

/// Returns the length of the derivative, mm per unit of t.
double speed(const shape& c, double t) noexcept
{
    return length(std::visit([t](const auto& s) { return derivative(s, t); }, c));
}

/// Speed at a parameter, and the derivative of the speed there.
struct speed_change {
    double speed = 0.0;
    double rate = 0.0; ///< NaN if the speed is 0
};

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

/// Returns the length between two parameters, by Gauss-Legendre quadrature with fifteen nodes.
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

/// Returns true if the speed is constant except for rounding, as on an arc of a circle.
bool is_uniform(const shape& c) noexcept
{
    const auto* e = std::get_if<elliptic>(&c);
    if (e == nullptr)
        return false;
    constexpr double rounding = 1e-14;
    const double u = dot(e->u, e->u);
    return std::abs(dot(e->v, e->v) - u) <= rounding * u && std::abs(dot(e->u, e->v)) <= rounding * u;
}

/// Returns the parameters inside (0, 1), ascending, at which the speed has an extremum, cusps included.
std::vector<double> speed_turns(const shape& c)
{
    return keep_inner_parameters(std::visit([](const auto& s) { return find_speed_turns(s); }, c));
}

/// Returns an upper bound of the length. Tolerances depend on it.
double rough_length(const shape& c) noexcept
{
    if (const auto* b = std::get_if<cubic>(&c))
        return distance_mm(b->p[0], b->p[1]) + distance_mm(b->p[1], b->p[2]) + distance_mm(b->p[2], b->p[3]);
    const auto& e = *std::get_if<elliptic>(&c);
    return std::abs(e.sweep) * (distance_mm({}, e.u) + distance_mm({}, e.v));
}

constexpr unsigned deepest = 48;

struct interval {
    double from;
    double to;
    double length;
    unsigned depth = 0;
};

// Returns true if the speed may have a kink at an end of the interval. Near a cusp the kink may be narrower
// than the gaps between the nodes, so comparing lengths does not find it. Cusps and points that are nearly
// cusps are ends of intervals. Intervals are halved until they are harmlessly short or have no slow end.
bool may_have_kink(const shape& c, const interval& i)
{
    constexpr double harmless_mm = 1e-6;
    const double mean = i.length / (i.to - i.from);
    return i.length > harmless_mm && std::min(speed(c, i.from), speed(c, i.to)) < 0.1 * mean;
}

/// Two neighbouring entries of the table, and the differences between their lengths and the length to find.
struct bracket {
    double from;
    double to;
    double below;
    double above;
    double first_speed;
    double last_speed;
};

/// Returns a first guess of the parameter between two entries: the cubic in s with the right slopes at both
/// ends, or the chord if the cubic leaves the interval.
double guess(const bracket& b)
{
    const auto& [from, to, below, above, first_speed, last_speed] = b;
    const double all = above - below;
    const double u = -below / all;
    const double chord = from + u * (to - from);
    const double first = all / first_speed - (to - from);
    const double last = all / last_speed - (to - from);
    const double t = chord + u * (1.0 - u) * ((1.0 - u) * first - u * last);
    return t > from && t < to ? t : chord;
}

/// Returns the parameter at which the length from `from` equals -below. Takes two or three steps of Halley's
/// method. Returns nothing if the steps do not converge, as near cusps.
std::optional<double> solve_halley(const shape& c, const bracket& b)
{
    const double from = b.from;
    const double to = b.to;
    constexpr int most_steps = 5;
    // Halley's method converges cubically: after such a step, the next one is smaller than the last digit.
    constexpr double converged = 1e-6;
    double t = guess(b);
    for (int i = 0; i < most_steps; ++i) {
        const double off = b.below + length_between(c, from, t);
        const speed_change v = speed_and_rate(c, t);
        const double straight = off / v.speed;
        const double step = straight / (1.0 - 0.5 * straight * v.rate / v.speed);
        t -= step;
        if (!(t >= from && t <= to && std::abs(step) <= to - from))
            return {};
        if (std::abs(step) <= converged * (to - from) && std::abs(straight * v.rate) <= 1e-3 * v.speed)
            return t;
    }
    return {};
}

/// Positions of the nodes in a piece, as parameters: (1 - cos(k pi / 6)) / 2.
constexpr std::array<double, 7> node_at{0.0, 0.0669872981077807, 0.25, 0.5, 0.75, 0.9330127018922193, 1.0};

/// Positions between the nodes, where the error of a polynomial is greatest.
constexpr std::array<double, 4> tried_at{0.03, 0.37, 0.63, 0.97};

/// Longest piece that counts as a single place, for example at a cusp.
constexpr double short_mm = 2e-10;

} // namespace

// Halves each interval until the lengths of its two halves add up to the length of the whole interval.
arc_length::arc_length(const shape& c) : even_(is_uniform(c)), t_{0.0}, s_{0.0}
{
    const double tolerance = std::max(1e-10, 1e-14 * rough_length(c));
    std::vector<double> ends = speed_turns(c);
    ends.push_back(1.0);
    for (const double end : ends) {
        if (end <= t_.back())
            continue;
        std::vector<interval> open{{t_.back(), end, length_between(c, t_.back(), end)}};
        while (!open.empty()) {
            const interval i = open.back();
            open.pop_back();
            const double middle = 0.5 * (i.from + i.to);
            const double left = length_between(c, i.from, middle);
            const double right = length_between(c, middle, i.to);
            const bool same = std::abs(left + right - i.length) <= tolerance;
            if (i.depth == deepest || (same && !may_have_kink(c, i))) {
                t_.push_back(i.to);
                s_.push_back(s_.back() + i.length);
            } else {
                open.push_back({middle, i.to, right, i.depth + 1});
                open.push_back({i.from, middle, left, i.depth + 1});
            }
        }
    }
    if (even_)
        return;
    speed_.reserve(t_.size());
    for (const double t : t_)
        speed_.push_back(speed(c, t));
}

double arc_length::at(const shape& c, double t) const noexcept
{
    if (!(t > 0.0))
        return 0.0;
    if (t >= 1.0)
        return total();
    if (even_)
        return t * total();
    const auto k = static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), t) - t_.begin()) - 1;
    return std::min(s_[k] + length_between(c, t_[k], t), s_[k + 1]);
}

double arc_length::parameter(const shape& c, double s_mm) const noexcept
{
    if (!(s_mm > 0.0))
        return 0.0;
    if (s_mm >= total())
        return 1.0;
    if (even_)
        return s_mm / total();
    const auto k = static_cast<std::size_t>(std::upper_bound(s_.begin(), s_.end(), s_mm) - s_.begin()) - 1;
    const auto excess = [&](double t) { return s_[k] + length_between(c, t_[k], t) - s_mm; };
    const double below = s_[k] - s_mm;
    const double above = s_[k + 1] - s_mm;
    if (!(below < 0.0))
        return t_[k];
    if (const auto t = solve_halley(c, {t_[k], t_[k + 1], below, above, speed_[k], speed_[k + 1]}))
        return *t;
    std::uintmax_t steps = 64;
    const auto [low, high] = boost::math::tools::toms748_solve(
        excess, t_[k], t_[k + 1], below, above, boost::math::tools::eps_tolerance<double>(51), steps);
    return 0.5 * (low + high);
}

point curve_places::piece::at(double s_mm) const noexcept
{
    point p = c[nodes - 1];
    for (std::size_t i = nodes - 1; i-- > 0;)
        p = c[i] + (s_mm - s[i]) * p;
    return p;
}

// Halves pieces of the curve until the error of each polynomial is small enough.
curve_places::curve_places(const shape& c, const arc_length& measure, std::size_t most)
{
    const double near_mm = std::max(2e-10, 1e-13 * rough_length(c)); // ten times the measure's own error
    std::vector<std::pair<double, double>> open{{0.0, 1.0}};
    while (!open.empty() && pieces_.size() <= most) {
        const auto [from, to] = open.back();
        open.pop_back();
        const auto parameter = [from = from, to = to](double part) { return from + part * (to - from); };
        piece p;
        for (std::size_t i = 0; i < nodes; ++i) {
            p.s[i] = measure.at(c, parameter(node_at[i]));
            p.c[i] = position(c, parameter(node_at[i]));
        }
        const bool is_short = p.s.back() - p.s.front() <= short_mm;
        for (std::size_t order = 1; order < nodes; ++order)
            for (std::size_t i = nodes - 1; i >= order; --i)
                p.c[i] = is_short ? point{} : 1.0 / (p.s[i] - p.s[i - order]) * (p.c[i] - p.c[i - 1]);
        const auto is_near = [&](double part) {
            const double t = parameter(part);
            return distance_mm(p.at(measure.at(c, t)), position(c, t)) <= near_mm;
        };
        if (is_short || std::all_of(tried_at.begin(), tried_at.end(), is_near)) {
            ends_mm_.push_back(p.s.back());
            pieces_.push_back(p);
        } else {
            open.emplace_back(parameter(0.5), to);
            open.emplace_back(from, parameter(0.5));
        }
    }
}

point curve_places::at(double s_mm) const noexcept
{
    const auto end = std::lower_bound(ends_mm_.begin(), ends_mm_.end() - 1, s_mm);
    return pieces_[static_cast<std::size_t>(end - ends_mm_.begin())].at(s_mm);
}

} // namespace tactor::detail
