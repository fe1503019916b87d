// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/trajectory/impl.hpp"
#include "core/words.hpp"
#include "plan/job.hpp"

namespace tactor::detail {
namespace {

std::vector<double> meeting_times(const std::vector<meeting>& points)
{
    std::vector<double> tau;
    for (const meeting& m : points)
        tau.push_back(m.t_s);
    return tau;
}

/// Returns the shortest duration in which the same movement is possible. The part of each burst before tau
/// (see parts_s()) is linear in the duration.
double shortest_duration_s(const timing_profile& p, const std::vector<double>& tau_s)
{
    // part = grow * T + fixed, with tau_i = share_i * T.
    double grow = 0.0;
    double fixed = 0.0;
    double shortest = 0.0;
    for (std::size_t i = 1; i < tau_s.size(); ++i) {
        const double share = (tau_s[i] - tau_s[i - 1]) / tau_s.back();
        grow = (share + (1.0 - p.slope) * grow) / (1.0 + p.slope);
        fixed = (-p.intercept_s + (1.0 - p.slope) * fixed) / (1.0 + p.slope);
        shortest = std::max(shortest, -fixed / grow);
    }
    return shortest;
}

[[noreturn]] void refuse(const job& j, const std::vector<double>& tau)
{
    const double shortest = shortest_duration_s(j.options.profile, tau);
    const bool possible = shortest <= longest_stroke_s;
    std::string advice = possible ? fmt::format("use at least {} s", format_seconds_up(shortest))
                                  : std::string("use a shorter path");
    if (!j.options.drop_points && tau.size() > 2)
        advice += ", or {drop_points=true} to leave places out";
    throw error(error_kind::bad_input, j.name(),
                fmt::format("{} too short for the Tactile Brush to play {} on the grid",
                            possible ? fmt::format("{} s is", format_seconds_down(tau.back()))
                                     : std::string("all durations up to a day are"),
                            counted(tau.size(), "place")),
                advice);
}

/// Drops places until the timing is possible, and reports them.
std::vector<meeting> drop_points(const job& j, const std::vector<meeting>& points, plan& out)
{
    const std::vector<std::size_t> keep = thin_out(j.options.profile, meeting_times(points));
    std::vector<meeting> rest;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool stays = rest.size() < keep.size() && keep[rest.size()] == i;
        (stays ? rest : out.dropped).push_back(points[i]);
    }
    if (out.dropped.empty())
        return rest;
    std::string places;
    constexpr std::size_t named = 8;
    for (std::size_t i = 0; i < std::min(named, out.dropped.size()); ++i)
        places += (i == 0 ? "" : ", ") + place(out.dropped[i].position);
    out.warnings.push_back(
        fmt::format("{} of {} places on the grid left out, because there is no time for them: {}{}",
                    out.dropped.size(), points.size(), places, out.dropped.size() > named ? ", ..." : ""));
    return rest;
}

/// Returns the interior virtual tactors in the order in which they are dropped: the smallest gap first. Of
/// tactors with equal gaps, the earliest tactor comes first.
std::vector<std::size_t> find_drop_order(const std::vector<double>& tau_s)
{
    const std::size_t n = tau_s.size();
    std::vector<std::size_t> before(n);
    std::vector<std::size_t> after(n);
    std::set<std::pair<long long, std::size_t>> by_gap;
    // Rounds to nanoseconds, so that equal gaps compare equal in spite of rounding errors.
    const auto gap = [&](std::size_t i) {
        return std::llround(std::min(tau_s[i] - tau_s[before[i]], tau_s[after[i]] - tau_s[i]) * 1e9);
    };
    const auto interior = [n](std::size_t i) { return i > 0 && i + 1 < n; };
    for (std::size_t i = 0; i < n; ++i) {
        before[i] = i - 1;
        after[i] = i + 1;
        if (interior(i))
            by_gap.insert({gap(i), i});
    }
    std::vector<std::size_t> order;
    while (!by_gap.empty()) {
        const std::size_t i = by_gap.begin()->second;
        const std::size_t a = before[i];
        const std::size_t b = after[i];
        for (const std::size_t k : {a, i, b})
            if (interior(k))
                by_gap.erase({gap(k), k});
        after[a] = b;
        before[b] = a;
        for (const std::size_t k : {a, b})
            if (interior(k))
                by_gap.insert({gap(k), k});
        order.push_back(i);
    }
    return order;
}

/// Returns the indices from 0 to n - 1, ascending, except the first `count` indices of `order`.
std::vector<std::size_t> remaining_places(std::size_t n, const std::vector<std::size_t>& order,
                                          std::size_t count)
{
    std::vector<bool> dropped(n, false);
    for (std::size_t k = 0; k < count; ++k)
        dropped[order[k]] = true;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < n; ++i)
        if (!dropped[i])
            places.push_back(i);
    return places;
}

struct virtual_tactor {
    double t_s = 0.0;
    point place;
    bool on_column = false;
    bool on_row = false;
    double moved_mm = 0.0; // distance by which the option snap moved the tactor
};

bool earlier(const virtual_tactor& a, const virtual_tactor& b)
{
    return a.t_s < b.t_s;
}

double nearest_line(const std::vector<double>& lines, double v)
{
    return *std::min_element(lines.begin(), lines.end(),
                             [v](double a, double b) { return std::abs(v - a) < std::abs(v - b); });
}

point nearest_grid_point(const grid_lines& g, point p)
{
    const point on_column{nearest_line(g.x_mm, p.x_mm), std::clamp(p.y_mm, g.y_mm.front(), g.y_mm.back())};
    const point on_row{std::clamp(p.x_mm, g.x_mm.front(), g.x_mm.back()), nearest_line(g.y_mm, p.y_mm)};
    return distance_mm(p, on_column) <= distance_mm(p, on_row) ? on_column : on_row;
}

/// Finds the crossings of the path with grid lines, in path order. Each crossing is exactly on a line.
std::vector<virtual_tactor> crossings(const job& j, const grid_lines& g)
{
    const trajectory& motion = j.motion.motion;
    std::vector<virtual_tactor> found;
    for (const double x : g.x_mm)
        for (const double t : motion.meets_x(x))
            found.push_back({t, {x, motion.position(t).y_mm}, true, false, 0.0});
    for (const double y : g.y_mm)
        for (const double t : motion.meets_y(y))
            found.push_back({t, {motion.position(t).x_mm, y}, false, true, 0.0});
    check_burst_count(j, static_cast<double>(found.size())); // checked before sorting many millions
    std::stable_sort(found.begin(), found.end(), earlier);
    return found;
}

/// The path of a stroke, in which places outside the array are moved to the nearest point of the array.
class in_array {
public:
    explicit in_array(const job& j) : job_(j) {}

    point move_inside(point p) const { return clamp_to_array(job_.faces, p); }
    point at(double t_s) const { return move_inside(job_.motion.motion.position(t_s)); }

    /// Returns true if a and b are at the same place, and the target does not leave this place in between.
    bool same(const virtual_tactor& a, const virtual_tactor& b) const
    {
        if (distance_mm(a.place, b.place) > same_place_mm)
            return false;
        const double margin = std::max(a.moved_mm, b.moved_mm) + 2.0 * same_place_mm;
        for (int i = 1; i < 8; ++i)
            if (distance_mm(a.place, at(a.t_s + (b.t_s - a.t_s) * i / 8.0)) > margin)
                return false;
        return true;
    }

private:
    const job& job_;
};

const double* line_at(const std::vector<double>& lines, double v)
{
    const auto near = std::lower_bound(lines.begin(), lines.end(), v - same_place_mm);
    return near != lines.end() && *near <= v + same_place_mm ? &*near : nullptr;
}

/// Adds the corners of the path that lie on a column and a row. crossings() misses such a corner if the path
/// turns from one line onto another, because a path does not cross a line along which it runs.
void add_corners(const job& j, const grid_lines& g, const in_array& path,
                 std::vector<virtual_tactor>& crossed)
{
    const trajectory& motion = j.motion.motion;
    std::vector<virtual_tactor> corners;
    for (const double t : access::of(motion).vertices()) {
        const point p = motion.position(t);
        const double* const x = line_at(g.x_mm, p.x_mm);
        const double* const y = line_at(g.y_mm, p.y_mm);
        if (x == nullptr || y == nullptr || !std::isfinite(t))
            continue;
        const virtual_tactor corner{t, {*x, *y}, true, true, 0.0};
        const auto next = std::lower_bound(crossed.begin(), crossed.end(), corner, earlier);
        const bool known = (next != crossed.end() && path.same(corner, *next)) ||
                           (next != crossed.begin() && path.same(*(next - 1), corner));
        if (!known)
            corners.push_back(corner);
    }
    const auto middle = crossed.insert(crossed.end(), corners.begin(), corners.end());
    std::inplace_merge(crossed.begin(), middle, crossed.end(), earlier);
    check_burst_count(j, static_cast<double>(crossed.size()));
}

/// Returns the start or end of the stroke.
/// \throws error if it is off the grid's lines and may not be moved.
virtual_tactor path_end(const job& j, const grid_lines& g, const in_array& path, bool start)
{
    virtual_tactor v;
    v.t_s = start ? 0.0 : j.motion.motion.duration_s();
    const point p = path.at(v.t_s);
    v.place = nearest_grid_point(g, p);
    v.moved_mm = distance_mm(p, v.place);
    if (v.moved_mm <= same_place_mm) {
        v.place = p;
        v.moved_mm = 0.0;
    } else if (!j.options.snap)
        throw error(error_kind::bad_input, j.name(),
                    fmt::format("it {} at {}, off the lines of the grid; the nearest point on a line is {}",
                                start ? "starts" : "ends", place(p), place(v.place)),
                    "use {snap=true} to use this point");
    return v;
}

void check_inside(const job& j, const std::vector<virtual_tactor>& crossed)
{
    follower target(j);
    double before = 0.0;
    target.at(0.0);
    const auto check_to = [&](double t) {
        target.at(before + (t - before) / 2.0);
        target.at(t);
        before = t;
    };
    for (const virtual_tactor& v : crossed)
        check_to(v.t_s);
    check_to(j.motion.motion.duration_s());
}

/// Lists the virtual tactors in path order: the start, each crossing with a grid line, and the end. Lists a
/// place twice only if the target leaves it in between, or if it is both start and end. So there are at least
/// two.
/// \throws error (bad_input) if the path leaves the array, or starts or ends off the grid's lines.
std::vector<meeting> virtual_tactors(const job& j, const grid_lines& grid)
{
    const in_array path(j);
    std::vector<virtual_tactor> crossed = crossings(j, grid);
    add_corners(j, grid, path, crossed);
    if (j.options.outside == outside_kind::error)
        check_inside(j, crossed);

    std::vector<virtual_tactor> all{path_end(j, grid, path, true)};
    const virtual_tactor last = path_end(j, grid, path, false);
    for (virtual_tactor& v : crossed) {
        v.place = path.move_inside(v.place);
        virtual_tactor& before = all.back();
        if (!path.same(before, v))
            all.push_back(v);
        else if (all.size() > 1) {
            // The path meets a row and a column here: use the exact place of the tactor.
            before.place.x_mm = v.on_column ? v.place.x_mm : before.place.x_mm;
            before.place.y_mm = v.on_row ? v.place.y_mm : before.place.y_mm;
        }
    }
    while (all.size() > 1 && path.same(all.back(), last))
        all.pop_back();
    all.push_back(last);

    std::vector<meeting> out;
    for (const virtual_tactor& v : all)
        out.push_back({v.t_s, v.place});
    return out;
}

} // namespace

void plan_brush(const job& j, plan& out)
{
    const std::optional<grid_lines> grid = find_grid(j.tactors);
    if (!grid)
        throw error(error_kind::bad_input, fmt::format("array \"{}\"", j.tactors.name),
                    "it is not a rectangular grid, which the Tactile Brush needs", "use {algorithm=park2016}")
            .with_field("algorithm");
    std::vector<meeting> points = virtual_tactors(j, *grid);
    if (j.options.drop_points)
        points = drop_points(j, points, out);
    const std::vector<double> tau = meeting_times(points);
    const std::vector<double> before = parts_s(j.options.profile, tau);
    if (before.empty())
        refuse(j, tau);

    for (std::size_t i = 0; i < points.size(); ++i) {
        const double after = i + 1 < points.size() ? before[i + 1] : 0.0;
        burst b = make_burst(j, tau[i] - before[i], before[i] + after, points[i].position, tau[i]);
        b.tau_s = tau[i];
        // The last burst ends with the stroke, but the burst before it may end later.
        out.total_s = std::max(out.total_s, b.onset_s + b.duration_s);
        out.bursts.push_back(std::move(b));
    }
}

std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s)
{
    constexpr double slack_s = 1e-10; // a part that is negative by a rounding error counts as 0
    std::vector<double> parts{0.0};
    for (std::size_t i = 1; i < tau_s.size(); ++i) {
        const double gap_s = tau_s[i] - tau_s[i - 1];
        const double part = (gap_s - p.intercept_s + (1.0 - p.slope) * parts.back()) / (1.0 + p.slope);
        if (!(part >= -slack_s))
            return {};
        parts.push_back(std::max(part, 0.0));
    }
    return parts;
}

std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s)
{
    const std::vector<std::size_t> order = find_drop_order(tau_s);
    const auto works = [&](std::size_t dropped) {
        std::vector<double> tau;
        for (const std::size_t i : remaining_places(tau_s.size(), order, dropped))
            tau.push_back(tau_s[i]);
        return !parts_s(p, tau).empty();
    };
    // If a place is dropped, the next part grows by (2 slope part + intercept) / (1 + slope), where `part` is
    // the part of the dropped place. No part is below -intercept / (2 slope), so the next part never shrinks:
    // a possible schedule stays possible if more places are dropped.
    std::size_t few = 0;
    std::size_t many = order.size();
    while (few < many) {
        const std::size_t half = few + (many - few) / 2;
        if (works(half))
            many = half;
        else
            few = half + 1;
    }
    return remaining_places(tau_s.size(), order, many);
}

} // namespace tactor::detail
