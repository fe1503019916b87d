// SPDX-License-Identifier: MIT
#include "core/trajectory/way.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <variant>

#include <boost/math/quadrature/gauss.hpp>

#include "core/access.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::detail {
namespace {

/// Greatest error of a line between two points, as a part of the smooth piece that it lies in.
constexpr double straight_enough = 5e-5;

/// Below it differences of parts are the last digits.
constexpr double last_digits = 1e-12;

/// Pieces of a smooth piece are no shorter than this part of its time.
constexpr unsigned finest = 4096;

/// Mean of a smooth pace: of so short a piece to the last digits.
double mean_part(const pace& p, double from_s, double to_s)
{
    return boost::math::quadrature::gauss<double, 7>::integrate(
        [&](double u) { return p.part(std::lerp(from_s, to_s, u)); }, 0.0, 1.0);
}

/// Points as near to each other as two numbers can be are one: a frequency is a difference by a time.
void add(std::vector<way_point>& way, way_point p)
{
    if (way.empty() || p.t_s > way.back().t_s)
        way.push_back(p);
    else
        way.back().part = p.part;
}

/// Points of a pace between two of its bends, the first excluded: as many as lines between them need.
void add_smooth(std::vector<way_point>& way, const pace& p, double from_s, double to_s)
{
    const auto when = [&](unsigned i) { return std::lerp(from_s, to_s, static_cast<double>(i) / finest); };
    const double error = std::max(straight_enough * (p.part(to_s) - p.part(from_s)), last_digits);
    const auto is_straight = [&](double begin_s, double end_s) {
        const double begin = p.part(begin_s);
        const double end = p.part(end_s);
        // In its middle an S is on the line, too.
        for (const double along : {0.25, 0.5, 0.75})
            if (std::abs(p.part(std::lerp(begin_s, end_s, along)) - std::lerp(begin, end, along)) > error)
                return false;
        return true;
    };
    unsigned step = finest;
    for (unsigned i = 0; i < finest;) {
        while (step > 1 && !is_straight(when(i), when(i + step)))
            step /= 2;
        const double begin_s = when(i);
        i += step;
        add(way, {when(i), p.part(when(i)), mean_part(p, begin_s, when(i))});
        step = std::min(2 * step, finest - i);
    }
}

std::vector<way_point> way_of(const pace& p, std::span<const double> at)
{
    std::vector<double> bends = p.bends();
    for (const double part : at)
        bends.push_back(p.arrival_s(part));
    std::sort(bends.begin(), bends.end());
    bends.erase(std::unique(bends.begin(), bends.end()), bends.end());
    std::vector<way_point> way{{0.0, 0.0}};
    for (std::size_t i = 0; i + 1 < bends.size(); ++i)
        add_smooth(way, p, bends[i], bends[i + 1]);
    way.back().part = 1.0;
    return way;
}

/// With a point at each part of `at` that lies between two, at constant speed.
std::vector<way_point> with_points(const std::vector<way_point>& way, std::span<const double> at)
{
    std::vector<way_point> out;
    auto next = at.begin();
    for (const way_point& to : way) {
        for (; next != at.end() && !out.empty() && *next < to.part; ++next) {
            const way_point from = out.back();
            if (*next > from.part)
                add(out, {std::lerp(from.t_s, to.t_s, (*next - from.part) / (to.part - from.part)), *next});
        }
        add(out, to);
    }
    for (std::size_t i = 1; i < out.size(); ++i)
        out[i].mean = std::midpoint(out[i - 1].part, out[i].part);
    return out;
}

std::vector<way_point> way_of(const std::vector<timed_point>& points)
{
    std::vector<way_point> way;
    way.reserve(points.size());
    double behind_mm = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0)
            behind_mm += distance_mm(points[i - 1].position, points[i].position);
        way.push_back({points[i].t_s, behind_mm});
    }
    for (way_point& w : way)
        w.part = behind_mm > 0.0 ? w.part / behind_mm : 0.0;
    return way;
}

} // namespace

std::vector<way_point> way_over_time(const trajectory& t, std::span<const double> at)
{
    const trajectory::impl& d = access::of(t);
    const auto* drawn = std::get_if<drawn_path>(&d.law);
    if (drawn != nullptr && !drawn->moves)
        return with_points({{0.0, 0.0}, {d.duration_s, 1.0}}, at);
    const std::vector<way_point> own = drawn != nullptr
                                           ? way_of(*drawn->moves, at)
                                           : with_points(way_of(*std::get<timed_points>(d.law).points), at);
    // Made for another duration, it is as much faster or slower everywhere.
    const double own_s = own.back().t_s;
    std::vector<way_point> way;
    way.reserve(own.size());
    for (const way_point& w : own)
        add(way, {own_s == d.duration_s ? w.t_s : w.t_s / own_s * d.duration_s, w.part, w.mean});
    return way;
}

} // namespace tactor::detail
