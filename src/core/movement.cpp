// SPDX-License-Identifier: MIT
// Trajectories along a path at changing speeds, and reversed trajectories.
#include <tactor/stroke.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/profile.hpp"
#include "core/refused.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::drawn_path;
using detail::pace;
using detail::timed_points;

double sum_of_rests(const movement& m)
{
    double all = 0.0;
    for (const rest& r : m.rests)
        all += r.time_s;
    return all;
}

/// Returns the time between the rests.
double moving_time_s(const movement& m, double length_mm)
{
    const double rests = sum_of_rests(m);
    if (!m.duration_s) {
        const double moving =
            m.speed_mm_s.empty() ? length_mm / default_speed_mm_s : detail::time_at_speeds_s(m, length_mm);
        detail::check_duration(moving + rests);
        return moving;
    }
    detail::check_duration(*m.duration_s);
    if (!(rests < *m.duration_s))
        throw detail::bad_field(
            "rests",
            fmt::format("{:g} s in all leave nothing of the {:g} s of the stroke", rests, *m.duration_s),
            "the duration is that of all, with its pauses");
    return *m.duration_s - rests;
}

bool is_even(const movement& m)
{
    return m.easing == easing_kind::linear && m.speed_mm_s.empty() && m.intensity.empty() && m.rests.empty();
}

/// Returns the outline of a path in reverse.
detail::outline backwards(const path::impl& p)
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

movement backwards(movement m)
{
    m.speed_mm_s = detail::from_the_end(m.speed_mm_s);
    m.intensity = detail::from_the_end(m.intensity);
    std::reverse(m.rests.begin(), m.rests.end());
    for (rest& r : m.rests)
        r.part = 1.0 - r.part;
    return m;
}

std::vector<timed_point> backwards(std::vector<timed_point> points)
{
    const double end = points.back().t_s;
    std::reverse(points.begin(), points.end());
    for (timed_point& p : points)
        p.t_s = end - p.t_s;
    return points;
}

} // namespace

trajectory trajectory::along(path p, const movement& m, double intensity)
{
    detail::check_movement(m);
    detail::check_intensity("stroke", intensity);
    const bool one_place = p.length_mm() == 0.0;
    if (one_place && (m.duration_s.value_or(0.0) == 0.0 || !m.intensity.empty() || !m.rests.empty()))
        detail::refuse_one_place();
    const double moving = moving_time_s(m, p.length_mm());
    if (one_place || is_even(m))
        return along(p, moving, intensity);
    auto moves = std::make_shared<const pace>(m, moving);
    const double duration = m.duration_s.value_or(moves->total_s());
    return trajectory(
        std::make_shared<impl>(impl{drawn_path{p, intensity, std::move(moves)}, duration, 1.0}));
}

trajectory trajectory::with_speed(double speed_mm_s) const
{
    const double length = length_mm();
    if (!(speed_mm_s > 0.0 && std::isfinite(speed_mm_s)))
        throw detail::bad_field("speed_mm_s", fmt::format("{:g} mm/s", speed_mm_s), "it is more than 0");
    if (!(length > 0.0))
        return *this;
    const double moving = length / speed_mm_s;
    const auto* c = std::get_if<drawn_path>(&impl_->law);
    if (c == nullptr || !c->moves || c->moves->given().rests.empty())
        return with_duration(moving);
    movement m = c->moves->given();
    const double stretched = impl_->duration_s / c->moves->total_s();
    for (rest& r : m.rests)
        r.time_s *= stretched;
    detail::check_duration(moving + sum_of_rests(m));
    auto moves = std::make_shared<const pace>(std::move(m), moving);
    const double duration = moves->total_s();
    return trajectory(std::make_shared<impl>(
        impl{drawn_path{c->way, c->intensity, std::move(moves)}, duration, impl_->gain}));
}

trajectory trajectory::reversed() const
{
    if (const auto* c = std::get_if<drawn_path>(&impl_->law)) {
        drawn_path l{detail::make_path(backwards(detail::access::of(c->way)), [] { return "stroke"; }),
                     c->intensity,
                     {}};
        if (c->moves)
            l.moves = std::make_shared<const pace>(backwards(c->moves->given()), c->moves->moving_s());
        return trajectory(std::make_shared<impl>(impl{std::move(l), impl_->duration_s, impl_->gain}));
    }
    const auto& l = std::get<timed_points>(impl_->law);
    const trajectory back = timed(backwards(*l.points));
    return trajectory(
        std::make_shared<impl>(impl{detail::access::of(back).law, impl_->duration_s, impl_->gain}));
}

} // namespace v0
} // namespace tactor
