// SPDX-License-Identifier: MIT
#include "plan/brush.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/access.hpp"
#include "core/trajectory/impl.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {
namespace {

struct virtual_tactor {
    double t_s = 0.0;
    point place;
    bool on_column = false;
    bool on_row = false;
    double moved_mm = 0.0; // by --snap
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

point nearest_on_grid(const grid_lines& g, point p)
{
    const point on_column{nearest_line(g.x_mm, p.x_mm), std::clamp(p.y_mm, g.y_mm.front(), g.y_mm.back())};
    const point on_row{std::clamp(p.x_mm, g.x_mm.front(), g.x_mm.back()), nearest_line(g.y_mm, p.y_mm)};
    return distance_mm(p, on_column) <= distance_mm(p, on_row) ? on_column : on_row;
}

/// Finds the crossings in path order. Each is exactly on its line.
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
    check_burst_count(j, static_cast<double>(found.size()));
    std::stable_sort(found.begin(), found.end(), earlier);
    return found;
}

/// A view of the path in the array, for looking anywhere on it.
class in_array {
public:
    explicit in_array(const job& j) : job_(j) {}

    point held(point p) const { return job_.faces.contains(p) ? p : job_.faces.nearest(p); }
    point at(double t_s) const { return held(job_.motion.motion.position(t_s)); }

    /// Returns true for two at one place that the target does not leave in between.
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

/// A stretch along a line meets the others only: where the path turns from one onto another neither tells of
/// the corner, which is on both.
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

/// Start or end of the stroke. \throws error when it is off the grid's lines and may not be moved.
virtual_tactor path_end(const job& j, const grid_lines& g, const in_array& path, bool start)
{
    virtual_tactor v;
    v.t_s = start ? 0.0 : j.motion.motion.duration_s();
    const point p = path.at(v.t_s);
    v.place = nearest_on_grid(g, p);
    v.moved_mm = distance_mm(p, v.place);
    if (v.moved_mm <= same_place_mm) {
        v.place = p;
        v.moved_mm = 0.0;
    } else if (!j.options.snap)
        throw error(error_kind::bad_input, j.name(),
                    fmt::format("{} at {}, which is on no line of the grid; the nearest point on one is {}",
                                start ? "starts" : "ends", place(p), place(v.place)),
                    "{snap=true} moves it there");
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

} // namespace

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
        v.place = path.held(v.place);
        virtual_tactor& before = all.back();
        if (!path.same(before, v))
            all.push_back(v);
        else if (all.size() > 1) {
            // A row and a column at once: exactly the tactor there.
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

} // namespace tactor::detail
