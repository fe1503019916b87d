// SPDX-License-Identifier: MIT
#include <tactor/stroke.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/path/impl.hpp"
#include "core/refused.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::detail {
namespace {

outline make_outline(const path::impl& p)
{
    outline o;
    o.vertices = p.vertices;
    o.curves.reserve(p.curves.size());
    for (const path::impl::measured_curve& c : p.curves)
        o.curves.push_back({c.segment, c.form});
    return o;
}

// Returns the outline with curves replaced by straight pieces, which end where the curves turn in direction
// `line`.
outline straighten_curves(const outline& o, point line)
{
    outline straight;
    straight.vertices.push_back(o.vertices.front());
    auto curve = o.curves.begin();
    for (std::size_t i = 0; i + 1 < o.vertices.size(); ++i) {
        if (curve != o.curves.end() && curve->segment == i) {
            for (const double t : find_turns_in_direction(curve->form, line))
                straight.line(position(curve->form, t));
            ++curve;
        }
        straight.line(o.vertices[i + 1]);
    }
    return straight;
}

} // namespace

void check_duration(double duration_s)
{
    if (!(duration_s > 0.0 && duration_s <= longest_stroke_s))
        throw bad_field("duration_s", fmt::format("{:g} s is out of range", duration_s),
                        fmt::format("give more than 0 and at most {:g} s", longest_stroke_s));
}

void check_intensity(std::string_view what, double intensity)
{
    if (!(intensity >= 0.0 && intensity <= max_intensity))
        throw error(error_kind::bad_input, what, fmt::format("intensity {:g} is out of range", intensity),
                    fmt::format("give a factor from 0 to {:g}", max_intensity))
            .with_field("intensity");
}

trajectory scale_intensity(const trajectory& t, double factor)
{
    trajectory::impl made = access::of(t);
    made.gain *= factor;
    return access::make<trajectory>(std::make_shared<const trajectory::impl>(std::move(made)));
}

void add_outline(const trajectory& t, std::vector<point>& corners, std::vector<shape>& curves)
{
    if (const auto* c = std::get_if<drawn_path>(&access::of(t).law)) {
        const path::impl& way = access::of(c->way);
        corners.insert(corners.end(), way.vertices.begin(), way.vertices.end());
        for (const path::impl::measured_curve& m : way.curves)
            curves.push_back(m.form);
        return;
    }
    for (const timed_point& p : *std::get<timed_points>(access::of(t).law).points)
        corners.push_back(p.position);
}

trajectory map_trajectory(const trajectory& t, point from, const affine& m, std::optional<point> line,
                          std::string_view what)
{
    const affine to_origin = translation({-from.x_mm, -from.y_mm});
    const trajectory::impl& d = access::of(t);
    if (const auto* c = std::get_if<drawn_path>(&d.law)) {
        outline o = apply_map(make_outline(access::of(c->way)), to_origin);
        if (line)
            o = straighten_curves(o, *line);
        drawn_path mapped_path{make_path(apply_map(std::move(o), m), what), c->intensity, c->moves};
        return access::make<trajectory>(std::make_shared<const trajectory::impl>(
            trajectory::impl{std::move(mapped_path), d.duration_s, d.gain}));
    }
    std::vector<timed_point> points = *std::get<timed_points>(d.law).points;
    for (timed_point& p : points)
        p.position = m(to_origin(p.position));
    return scale_intensity(trajectory::timed(std::move(points)).with_duration(d.duration_s), d.gain);
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {
namespace {

using detail::axis;
using detail::check_duration;
using detail::check_intensity;
using detail::drawn_path;
using detail::pace;
using detail::timed_points;

/// Throws error (bad_input), which asks for a duration because the path is a single place.
[[noreturn]] void refuse_one_place()
{
    throw error(error_kind::bad_input, "path", "it has no length", "add {duration_s} to make it a tap")
        .with_field("duration_s");
}

void check_point(const std::vector<timed_point>& points, std::size_t i)
{
    const timed_point& p = points[i];
    const auto refuse = [i](std::string_view why, std::string_view hint) {
        throw error(error_kind::bad_input, fmt::format("point {}", i + 1), why, hint);
    };
    if (!(std::abs(p.t_s) <= detail::longest_stroke_s))
        refuse(fmt::format("time {:g} s is out of range", p.t_s),
               fmt::format("use at most {:g} s", detail::longest_stroke_s));
    for (const double v : {p.position.x_mm, p.position.y_mm})
        if (!(std::abs(v) <= detail::max_mm))
            refuse(fmt::format("coordinate {:g} mm is out of range", v),
                   fmt::format("give at most {:g} mm", detail::max_mm));
    check_intensity(fmt::format("point {}", i + 1), p.intensity);
    if (i == 0 && p.t_s != 0.0)
        refuse(fmt::format("the first time is {} s", p.t_s), "start at 0 s");
    if (i > 0 && !(p.t_s > points[i - 1].t_s))
        refuse(fmt::format("time {} s is not after the previous one, {} s", p.t_s, points[i - 1].t_s),
               "put times in ascending order");
}

double find_max_intensity(const trajectory::impl& i)
{
    if (const auto* c = std::get_if<drawn_path>(&i.law))
        return i.gain * c->intensity * (c->moves ? c->moves->intensity_bound(0.0, 1.0) : 1.0);
    double most = 0.0;
    for (const timed_point& p : *std::get<timed_points>(i.law).points)
        most = std::max(most, p.intensity);
    return i.gain * most;
}

// Points as nodes for find_intersections.
class timed_nodes {
public:
    timed_nodes(const std::vector<timed_point>& points, axis a, double line)
        : points_(points), axis_(a), line_(line)
    {
    }
    std::size_t size() const { return points_.size(); }
    double signed_distance(std::size_t i) const
    {
        return detail::coordinate(points_[i].position, axis_) - line_;
    }
    double progress(std::size_t i) const { return points_[i].t_s; }
    double length(std::size_t i, std::size_t j) const
    {
        double sum = 0.0;
        for (; i < j; ++i)
            sum += distance_mm(points_[i].position, points_[i + 1].position);
        return sum;
    }
    double find_crossing(std::size_t i) const
    {
        return progress(i) + (progress(i + 1) - progress(i)) *
                                 (signed_distance(i) / (signed_distance(i) - signed_distance(i + 1)));
    }

private:
    const std::vector<timed_point>& points_;
    axis axis_;
    double line_;
};

double sum_of_rests(const movement& m)
{
    double all = 0.0;
    for (const rest& r : m.rests)
        all += r.time_s;
    return all;
}

/// Returns the time that a movement takes without its rests.
double moving_time_s(const movement& m, double length_mm)
{
    const double rests = sum_of_rests(m);
    if (!m.duration_s) {
        const double moving =
            m.speed_mm_s.empty() ? length_mm / default_speed_mm_s : detail::travel_time_s(m, length_mm);
        check_duration(moving + rests);
        return moving;
    }
    check_duration(*m.duration_s);
    if (!(rests < *m.duration_s))
        throw detail::bad_field(
            "pauses",
            fmt::format("their total of {:g} s leaves no time to move in a stroke of {:g} s", rests,
                        *m.duration_s),
            "use shorter pauses, or a longer duration, which includes them");
    return *m.duration_s - rests;
}

bool is_uniform(const movement& m)
{
    return m.easing == easing_kind::linear && m.speed_mm_s.empty() && m.intensity.empty() && m.rests.empty();
}

/// Returns the outline of a path in reverse.
detail::outline make_reverse(const path::impl& p)
{
    detail::outline o;
    o.vertices.assign(p.vertices.rbegin(), p.vertices.rend());
    for (auto c = p.curves.rbegin(); c != p.curves.rend(); ++c) {
        detail::shape form = c->form;
        if (auto* cubic = std::get_if<detail::cubic>(&form)) {
            std::reverse(cubic->p.begin(), cubic->p.end());
        } else {
            auto& arc = std::get<detail::elliptic>(form);
            arc.from += arc.sweep;
            arc.sweep = -arc.sweep;
        }
        o.curves.push_back({p.vertices.size() - 2 - c->segment, form});
    }
    return o;
}

movement make_reverse(movement m)
{
    m.speed_mm_s = detail::reverse_parts(m.speed_mm_s);
    m.intensity = detail::reverse_parts(m.intensity);
    m.rests = detail::reverse_parts(m.rests);
    return m;
}

std::vector<timed_point> make_reverse(std::vector<timed_point> points)
{
    const double end = points.back().t_s;
    std::reverse(points.begin(), points.end());
    for (timed_point& p : points)
        p.t_s = end - p.t_s;
    return points;
}

} // namespace

trajectory::impl::bracket trajectory::impl::find(const detail::timed_points& l, double t_s) const noexcept
{
    const std::vector<timed_point>& p = *l.points;
    const double t = to_own_time(t_s, l.duration_s());
    if (!(t > 0.0))
        return {&p.front(), &p.front(), 0.0};
    if (t >= p.back().t_s || t_s >= duration_s)
        return {&p.back(), &p.back(), 0.0};
    const auto after = std::upper_bound(p.begin(), p.end(), t,
                                        [](double v, const timed_point& q) noexcept { return v < q.t_s; });
    const timed_point& a = *(after - 1);
    return {&a, &*after, (t - a.t_s) / (after->t_s - a.t_s)};
}

std::vector<double> trajectory::impl::find_meetings(axis a, double line) const
{
    std::vector<double> times;
    if (!std::isfinite(line))
        return times;
    if (const auto* c = std::get_if<drawn_path>(&law)) {
        times = a == axis::x ? c->way.meets_x(line) : c->way.meets_y(line);
        for (double& t : times)
            t = arrival_s(*c, t);
        return times;
    }
    const auto& l = std::get<timed_points>(law);
    times = detail::find_intersections(timed_nodes(*l.points, a, line));
    for (double& t : times)
        t = from_own_time(t, l.duration_s());
    return times;
}

std::vector<double> trajectory::impl::vertices() const
{
    std::vector<double> times;
    if (const auto* c = std::get_if<drawn_path>(&law)) {
        for (const double s : detail::access::of(c->way).s)
            times.push_back(arrival_s(*c, s));
        return times;
    }
    const auto& l = std::get<timed_points>(law);
    for (const timed_point& p : *l.points)
        times.push_back(from_own_time(p.t_s, l.duration_s()));
    return times;
}

trajectory::trajectory() : trajectory(timed({{.t_s = 0.0}, {.t_s = 1.0}}))
{
}

trajectory trajectory::along(path p, double duration_s, double intensity)
{
    const bool rests = p.length_mm() == 0.0;
    if (rests && duration_s == 0.0)
        refuse_one_place();
    check_duration(duration_s);
    check_intensity("stroke", intensity);
    if (rests)
        return timed({{0.0, p.at(0.0), intensity}, {duration_s, p.at(0.0), intensity}});
    return trajectory(std::make_shared<impl>(impl{drawn_path{p, intensity, {}}, duration_s, 1.0}));
}

trajectory trajectory::along(path p, const movement& m, double intensity)
{
    detail::check_movement(m);
    check_intensity("stroke", intensity);
    const bool one_place = p.length_mm() == 0.0;
    if (one_place && (m.duration_s.value_or(0.0) == 0.0 || !m.intensity.empty() || !m.rests.empty()))
        refuse_one_place();
    const double moving = moving_time_s(m, p.length_mm());
    if (one_place || is_uniform(m))
        return along(p, moving, intensity);
    auto moves = std::make_shared<const pace>(m, moving);
    const double duration = m.duration_s.value_or(moves->total_s());
    return trajectory(
        std::make_shared<impl>(impl{drawn_path{p, intensity, std::move(moves)}, duration, 1.0}));
}

trajectory trajectory::timed(std::vector<timed_point> points)
{
    if (points.size() < 2)
        throw error(error_kind::bad_input, "timed points",
                    fmt::format("a stroke needs at least 2, but this one has {}", points.size()),
                    "give the start and the end of the stroke")
            .with_field("points");
    double length = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        check_point(points, i);
        if (i > 0)
            length += distance_mm(points[i - 1].position, points[i].position);
    }
    const double duration = points.back().t_s;
    auto shared = std::make_shared<const std::vector<timed_point>>(std::move(points));
    return trajectory(std::make_shared<impl>(impl{timed_points{std::move(shared), length}, duration, 1.0}));
}

trajectory trajectory::with_duration(double duration_s) const
{
    check_duration(duration_s);
    return trajectory(std::make_shared<impl>(impl{impl_->law, duration_s, impl_->gain}));
}

trajectory trajectory::with_speed(double speed_mm_s) const
{
    const double length = length_mm();
    if (!(speed_mm_s > 0.0 && std::isfinite(speed_mm_s)))
        throw detail::bad_field("speed_mm_s", fmt::format("{:g} mm/s is out of range", speed_mm_s),
                                "give more than 0 mm/s");
    if (!(length > 0.0))
        return *this;
    const double moving = length / speed_mm_s;
    const auto* c = std::get_if<drawn_path>(&impl_->law);
    if (c == nullptr || !c->moves || c->moves->definition().rests.empty())
        return with_duration(moving);
    movement m = c->moves->definition();
    const double stretched = impl_->duration_s / c->moves->total_s();
    for (rest& r : m.rests)
        r.time_s *= stretched;
    check_duration(moving + sum_of_rests(m));
    auto moves = std::make_shared<const pace>(std::move(m), moving);
    const double duration = moves->total_s();
    return trajectory(std::make_shared<impl>(
        impl{drawn_path{c->way, c->intensity, std::move(moves)}, duration, impl_->gain}));
}

trajectory trajectory::reversed() const
{
    if (const auto* c = std::get_if<drawn_path>(&impl_->law)) {
        drawn_path l{detail::make_path(make_reverse(detail::access::of(c->way)), "stroke"), c->intensity, {}};
        if (c->moves)
            l.moves =
                std::make_shared<const pace>(make_reverse(c->moves->definition()), c->moves->moving_s());
        return trajectory(std::make_shared<impl>(impl{std::move(l), impl_->duration_s, impl_->gain}));
    }
    const auto& l = std::get<timed_points>(impl_->law);
    const trajectory back = timed(make_reverse(*l.points));
    return trajectory(
        std::make_shared<impl>(impl{detail::access::of(back).law, impl_->duration_s, impl_->gain}));
}

trajectory trajectory::with_intensity(double factor) const
{
    check_intensity("stroke", factor < 0.0 ? factor : factor * find_max_intensity(*impl_));
    return detail::scale_intensity(*this, factor);
}

double trajectory::duration_s() const noexcept
{
    return impl_->duration_s;
}

double trajectory::length_mm() const noexcept
{
    if (const auto* c = std::get_if<drawn_path>(&impl_->law))
        return c->way.length_mm();
    return std::get_if<timed_points>(&impl_->law)->length_mm;
}

point trajectory::position(double t_s) const noexcept
{
    if (const auto* c = std::get_if<drawn_path>(&impl_->law)) {
        const double part =
            c->moves ? c->moves->part(impl_->to_own_time(t_s, c->moves->total_s())) : t_s / impl_->duration_s;
        return c->way.at(part * c->way.length_mm());
    }
    const auto b = impl_->find(*std::get_if<timed_points>(&impl_->law), t_s);
    return detail::interpolate_points(b.before->position, b.after->position, b.part);
}

double trajectory::intensity(double t_s) const noexcept
{
    if (const auto* c = std::get_if<drawn_path>(&impl_->law))
        return impl_->gain * c->intensity *
               (c->moves ? c->moves->intensity(impl_->to_own_time(t_s, c->moves->total_s())) : 1.0);
    const auto b = impl_->find(*std::get_if<timed_points>(&impl_->law), t_s);
    return impl_->gain * (b.before->intensity + b.part * (b.after->intensity - b.before->intensity));
}

std::vector<double> trajectory::meets_x(double x_mm) const
{
    return impl_->find_meetings(axis::x, x_mm);
}

std::vector<double> trajectory::meets_y(double y_mm) const
{
    return impl_->find_meetings(axis::y, y_mm);
}

} // namespace v0
} // namespace tactor
