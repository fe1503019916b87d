// SPDX-License-Identifier: MIT
#include "core/trajectory/spans.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::detail {
namespace {

using visitor = std::function<bool(const trajectory_span&)>;

void along_path(const trajectory::impl& motion, const drawn_path& law, const visitor& visit)
{
    const path::impl& way = detail::access::of(law.way);
    const double duration_s = motion.duration_s;
    const double length = way.s.back();
    const auto when = [&](double s_mm) { return motion.arrival_s(law, std::min(s_mm, length)); };
    const double steady = motion.gain * law.intensity;
    trajectory_span span;
    span.intensity = steady;
    auto curve = way.curves.begin();
    for (std::size_t i = 0; i + 1 < way.vertices.size(); ++i) {
        span.from_s = span.to_s;
        span.to_s = i + 2 == way.vertices.size() ? duration_s : when(way.s[i + 1]);
        if (law.moves)
            span.intensity = steady * law.moves->greatest(way.s[i] / length, way.s[i + 1] / length);
        span.curve = nullptr;
        span.time_at = nullptr;
        if (curve != way.curves.end() && curve->segment == i) {
            span.curve = &curve->form;
            span.time_at = [&way, &when, i, c = &*curve](double parameter) {
                return when(way.s[i] + c->measure.at(c->form, parameter));
            };
            ++curve;
        }
        if (!visit(span))
            return;
    }
}

void between_points(const timed_points& law, double duration_s, double gain, const visitor& visit)
{
    const std::vector<timed_point>& p = *law.points;
    const double own = law.duration_s();
    trajectory_span span;
    for (std::size_t i = 0; i + 1 < p.size(); ++i) {
        span.from_s = span.to_s;
        span.to_s = own == duration_s ? p[i + 1].t_s : p[i + 1].t_s / own * duration_s;
        span.intensity = gain * std::max(p[i].intensity, p[i + 1].intensity);
        if (!visit(span))
            return;
    }
}

/// Greatest error of a line between two points, as a part of the smooth piece around it.
constexpr double straight_enough = 5e-5;

/// Difference of parts that is within rounding.
constexpr double last_digits = 1e-12;

/// Points of a smooth piece are at least 1/finest of its time apart.
constexpr unsigned finest = 4096;

/// Adds a point. Points with equal times are joined, because a frequency is a difference divided by a time.
void add(std::vector<way_point>& way, way_point p)
{
    if (way.empty() || p.t_s > way.back().t_s)
        way.push_back(p);
    else
        way.back().part = p.part;
}

/// Adds points of a pace between two of its bends, the first excluded: as many as the error allows lines
/// between them.
void add_smooth(std::vector<way_point>& way, const pace& p, double from_s, double to_s)
{
    const auto when = [&](unsigned i) { return std::lerp(from_s, to_s, static_cast<double>(i) / finest); };
    const double error = std::max(straight_enough * (p.part(to_s) - p.part(from_s)), last_digits);
    const auto is_straight = [&](double begin_s, double end_s) {
        const double begin = p.part(begin_s);
        const double end = p.part(end_s);
        // Checks the quarters, too: an S meets the line in its middle.
        for (const double along : {0.25, 0.5, 0.75})
            if (std::abs(p.part(std::lerp(begin_s, end_s, along)) - std::lerp(begin, end, along)) > error)
                return false;
        return true;
    };
    unsigned step = finest;
    for (unsigned i = 0; i < finest;) {
        while (step > 1 && !is_straight(when(i), when(i + step)))
            step /= 2;
        i += step;
        add(way, {when(i), p.part(when(i))});
        step = std::min(2 * step, finest - i);
    }
}

std::vector<double> find_bends(const pace& p, std::span<const double> at)
{
    std::vector<double> bends = p.bends();
    for (const double part : at)
        bends.push_back(p.arrival_s(part));
    std::sort(bends.begin(), bends.end());
    bends.erase(std::unique(bends.begin(), bends.end()), bends.end());
    return bends;
}

std::vector<way_point> way_of(const pace& p)
{
    const std::vector<double> bends = find_bends(p, {});
    std::vector<way_point> way{{0.0, 0.0}};
    for (std::size_t i = 0; i + 1 < bends.size(); ++i)
        add_smooth(way, p, bends[i], bends[i + 1]);
    way.back().part = 1.0;
    return way;
}

/// Returns the points with one more at each part of `at` that lies between two, assuming constant speed.
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

/// Returns the pace of a trajectory, or null if it moves at constant speeds.
const pace* find_smooth_law(const trajectory& t)
{
    const auto* drawn = std::get_if<drawn_path>(&access::of(t).law);
    return drawn != nullptr ? drawn->moves.get() : nullptr;
}

/// Scales the times to the duration of this trajectory, which may differ from its pace's own.
std::vector<way_point> scale_times(const trajectory& t, const std::vector<way_point>& own)
{
    const double duration_s = access::of(t).duration_s;
    const double own_s = own.back().t_s;
    std::vector<way_point> way;
    way.reserve(own.size());
    for (const way_point& w : own)
        add(way, {own_s == duration_s ? w.t_s : w.t_s / own_s * duration_s, w.part});
    return way;
}

std::vector<way_point> find_linear_way(const trajectory& t, std::span<const double> at)
{
    const trajectory::impl& d = access::of(t);
    if (const auto* timed = std::get_if<timed_points>(&d.law))
        return scale_times(t, with_points(way_of(*timed->points), at));
    return with_points({{0.0, 0.0}, {d.duration_s, 1.0}}, at);
}

} // namespace

void for_each_span(const trajectory& t, const visitor& visit)
{
    const trajectory::impl& d = detail::access::of(t);
    if (const auto* c = std::get_if<drawn_path>(&d.law))
        along_path(d, *c, visit);
    else
        between_points(*std::get_if<timed_points>(&d.law), d.duration_s, d.gain, visit);
}

std::vector<way_point> way_over_time(const trajectory& t)
{
    const pace* smooth = find_smooth_law(t);
    return smooth != nullptr ? scale_times(t, way_of(*smooth)) : find_linear_way(t, {});
}

smooth_way find_smooth_way(const trajectory& t, std::span<const double> at)
{
    smooth_way way;
    if (const pace* p = find_smooth_law(t)) {
        const double duration_s = access::of(t).duration_s;
        std::vector<double> own_s;
        for (const double when_s : find_bends(*p, at)) {
            const double t_s = p->total_s() == duration_s ? when_s : when_s / p->total_s() * duration_s;
            if (own_s.empty() || t_s > way.points.back().t_s) {
                way.points.emplace_back();
                own_s.emplace_back();
            }
            way.points.back() = {t_s, p->part(when_s)};
            own_s.back() = when_s;
        }
        way.points.back().part = 1.0;
        way.part = [p, own_s = std::move(own_s)](std::size_t i, double u) {
            return p->part(std::lerp(own_s[i], own_s[i + 1], u));
        };
        return way;
    }
    way.points = find_linear_way(t, at);
    way.part = [points = way.points](std::size_t i, double u) {
        return std::lerp(points[i].part, points[i + 1].part, u);
    };
    return way;
}

} // namespace tactor::detail
