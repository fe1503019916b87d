// SPDX-License-Identifier: MIT
#include "core/trajectory/spans.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::detail {
namespace {

using visitor = std::function<bool(const trajectory_span&)>;

void visit_path_spans(const trajectory::impl& motion, const drawn_path& law, const visitor& visit)
{
    const path::impl& outline = detail::access::of(law.way);
    const double duration_s = motion.duration_s;
    const double length = outline.s.back();
    const auto when = [&](double s_mm) { return motion.arrival_s(law, std::min(s_mm, length)); };
    const double steady = motion.gain * law.intensity;
    trajectory_span span;
    span.intensity = steady;
    auto curve = outline.curves.begin();
    for (std::size_t i = 0; i + 1 < outline.vertices.size(); ++i) {
        span.from_s = span.to_s;
        span.to_s = i + 2 == outline.vertices.size() ? duration_s : when(outline.s[i + 1]);
        if (law.moves)
            span.intensity =
                steady * law.moves->intensity_bound(outline.s[i] / length, outline.s[i + 1] / length);
        span.curve = nullptr;
        span.time_at = nullptr;
        if (curve != outline.curves.end() && curve->segment == i) {
            span.curve = &curve->form;
            span.time_at = [&outline, &when, i, c = &*curve](double parameter) {
                return when(outline.s[i] + c->measure.at(c->form, parameter));
            };
            ++curve;
        }
        if (!visit(span))
            return;
    }
}

void visit_point_spans(const trajectory::impl& motion, const timed_points& law, const visitor& visit)
{
    const std::vector<timed_point>& p = *law.points;
    trajectory_span span;
    for (std::size_t i = 0; i + 1 < p.size(); ++i) {
        span.from_s = span.to_s;
        span.to_s = motion.from_own_time(p[i + 1].t_s, law.duration_s());
        span.intensity = motion.gain * std::max(p[i].intensity, p[i + 1].intensity);
        if (!visit(span))
            return;
    }
}

/// Greatest error of a line between two points, as a fraction of the smooth piece that contains it.
constexpr double straight_enough = 5e-5;

/// Difference between two parts that may be a rounding error.
constexpr double last_digits = 1e-12;

/// Finest division of a smooth piece: its points are at least 1/finest of its time apart.
constexpr unsigned finest = 4096;

/// Adds a point. Points with equal times are merged, because frequencies are computed by dividing by time
/// differences.
void add(std::vector<progress_point>& progress, progress_point p)
{
    if (progress.empty() || p.t_s > progress.back().t_s)
        progress.push_back(p);
    else
        progress.back().part = p.part;
}

/// Adds points of a pace after one bend up to the next. There are enough points that straight lines between
/// them stay within the error.
void add_smooth_points(std::vector<progress_point>& progress, const pace& p, double from_s, double to_s)
{
    const auto when = [&](unsigned i) { return std::lerp(from_s, to_s, static_cast<double>(i) / finest); };
    const double error = std::max(straight_enough * (p.part(to_s) - p.part(from_s)), last_digits);
    const auto is_straight = [&](double begin_s, double end_s) {
        const double begin = p.part(begin_s);
        const double end = p.part(end_s);
        // Also checks the quarters, because an S-shaped curve meets the line in its middle.
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
        add(progress, {when(i), p.part(when(i))});
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

std::vector<progress_point> trace(const pace& p)
{
    const std::vector<double> bends = find_bends(p, {});
    std::vector<progress_point> progress{{0.0, 0.0}};
    for (std::size_t i = 0; i + 1 < bends.size(); ++i)
        add_smooth_points(progress, p, bends[i], bends[i + 1]);
    progress.back().part = 1.0;
    return progress;
}

/// Returns the points, with an interpolated point for each part in `at` that is between two points. Assumes
/// constant speed between points.
std::vector<progress_point> insert_points(const std::vector<progress_point>& progress,
                                          std::span<const double> at)
{
    std::vector<progress_point> out;
    auto next = at.begin();
    for (const progress_point& to : progress) {
        for (; next != at.end() && !out.empty() && *next < to.part; ++next) {
            const progress_point from = out.back();
            if (*next > from.part)
                add(out, {std::lerp(from.t_s, to.t_s, (*next - from.part) / (to.part - from.part)), *next});
        }
        add(out, to);
    }
    return out;
}

std::vector<progress_point> trace(const std::vector<timed_point>& points)
{
    std::vector<progress_point> progress;
    progress.reserve(points.size());
    double behind_mm = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0)
            behind_mm += distance_mm(points[i - 1].position, points[i].position);
        progress.push_back({points[i].t_s, behind_mm});
    }
    for (progress_point& w : progress)
        w.part = behind_mm > 0.0 ? w.part / behind_mm : 0.0;
    return progress;
}

/// Returns the pace of a trajectory, or null if it moves at constant speeds.
const pace* find_pace(const trajectory& t)
{
    const auto* drawn = std::get_if<drawn_path>(&access::of(t).law);
    return drawn != nullptr ? drawn->moves.get() : nullptr;
}

/// Scales times of a pace to the duration of this trajectory, which may differ from that of the pace.
std::vector<progress_point> scale_times(const trajectory& t, const std::vector<progress_point>& own)
{
    std::vector<progress_point> progress;
    progress.reserve(own.size());
    for (const progress_point& w : own)
        add(progress, {access::of(t).from_own_time(w.t_s, own.back().t_s), w.part});
    return progress;
}

std::vector<progress_point> find_linear_progress(const trajectory& t, std::span<const double> at)
{
    const trajectory::impl& d = access::of(t);
    if (const auto* timed = std::get_if<timed_points>(&d.law))
        return scale_times(t, insert_points(trace(*timed->points), at));
    return insert_points({{0.0, 0.0}, {d.duration_s, 1.0}}, at);
}

// Half of the promised error, because the error between the checked places may be a little larger.
constexpr double tolerance_mm = 0.005;
constexpr double tolerance_intensity = 0.002;
constexpr double shortest_s = 1e-4;
constexpr std::size_t most_sampled_points = 1'000'000;

// Returns points at the given times. Adds points between them by halving each stretch that is not straight.
std::vector<timed_point> sample_between(const trajectory& t, const std::vector<double>& times)
{
    const auto at = [&t](double t_s) { return timed_point{t_s, t.position(t_s), t.intensity(t_s)}; };
    const auto is_straight = [&at](const timed_point& a, const timed_point& b) {
        for (const double part : {0.25, 0.5, 0.75}) {
            const timed_point p = at(std::lerp(a.t_s, b.t_s, part));
            const point even{std::lerp(a.position.x_mm, b.position.x_mm, part),
                             std::lerp(a.position.y_mm, b.position.y_mm, part)};
            if (distance_mm(p.position, even) > tolerance_mm ||
                std::abs(p.intensity - std::lerp(a.intensity, b.intensity, part)) > tolerance_intensity)
                return false;
        }
        return true;
    };
    std::vector<timed_point> points{at(times.front())};
    for (std::size_t i = 1; i < times.size(); ++i) {
        std::vector<timed_point> ends{at(times[i])};
        while (!ends.empty()) {
            const timed_point last = points.back();
            const timed_point next = ends.back();
            if (next.t_s - last.t_s > shortest_s && !is_straight(last, next)) {
                ends.push_back(at(0.5 * (last.t_s + next.t_s)));
                continue;
            }
            points.push_back(next);
            ends.pop_back();
            if (points.size() > most_sampled_points)
                throw error(error_kind::bad_input, "stroke",
                            fmt::format("it needs more than {} timed points", most_sampled_points),
                            "make the stroke shorter or simpler");
        }
    }
    return points;
}

// Returns the times at which the movement may not be smooth, ascending, from 0 to the duration.
std::vector<double> find_break_times(const trajectory::impl& i, const drawn_path& law)
{
    std::vector<double> times{0.0, i.duration_s};
    if (law.way.length_mm() > 0.0)
        times = i.vertices();
    if (law.moves) {
        for (const double t : law.moves->bends())
            times.push_back(i.from_own_time(t, law.moves->total_s()));
        for (const profile_point& p : law.moves->definition().intensity)
            times.push_back(i.from_own_time(law.moves->arrival_s(p.part), law.moves->total_s()));
    }
    std::sort(times.begin(), times.end());
    times.front() = 0.0;
    times.back() = i.duration_s;
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

} // namespace

void for_each_span(const trajectory& t, const visitor& visit)
{
    const trajectory::impl& d = detail::access::of(t);
    if (const auto* c = std::get_if<drawn_path>(&d.law))
        visit_path_spans(d, *c, visit);
    else
        visit_point_spans(d, *std::get_if<timed_points>(&d.law), visit);
}

std::vector<progress_point> progress_over_time(const trajectory& t)
{
    const pace* smooth = find_pace(t);
    return smooth != nullptr ? scale_times(t, trace(*smooth)) : find_linear_progress(t, {});
}

smooth_progress find_smooth_progress(const trajectory& t, std::span<const double> at)
{
    smooth_progress progress;
    if (const pace* p = find_pace(t)) {
        std::vector<double> own_s;
        for (const double when_s : find_bends(*p, at)) {
            const double t_s = access::of(t).from_own_time(when_s, p->total_s());
            if (own_s.empty() || t_s > progress.points.back().t_s) {
                progress.points.emplace_back();
                own_s.emplace_back();
            }
            progress.points.back() = {t_s, p->part(when_s)};
            own_s.back() = when_s;
        }
        progress.points.back().part = 1.0;
        progress.part = [p, own_s = std::move(own_s)](std::size_t i, double u) {
            return p->part(std::lerp(own_s[i], own_s[i + 1], u));
        };
        return progress;
    }
    progress.points = find_linear_progress(t, at);
    progress.part = [points = progress.points](std::size_t i, double u) {
        return std::lerp(points[i].part, points[i + 1].part, u);
    };
    return progress;
}

std::vector<timed_point> sample_points(const trajectory& t)
{
    const trajectory::impl& i = access::of(t);
    if (const auto* law = std::get_if<drawn_path>(&i.law))
        return sample_between(t, find_break_times(i, *law));
    const auto& law = std::get<timed_points>(i.law);
    std::vector<timed_point> points = *law.points;
    for (timed_point& p : points) {
        p.t_s = i.from_own_time(p.t_s, law.duration_s());
        p.intensity *= i.gain;
    }
    return points;
}

} // namespace tactor::detail
