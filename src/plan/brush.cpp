// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "core/words.hpp"
#include "plan/brush_points.hpp"
#include "plan/brush_timing.hpp"
#include "plan/job.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {
namespace {

constexpr double longest_stroke_s = 86400.0;

std::vector<double> times_of(const std::vector<meeting>& points)
{
    std::vector<double> tau;
    for (const meeting& m : points)
        tau.push_back(m.t_s);
    return tau;
}

[[noreturn]] void refuse(const job& j, const std::vector<double>& tau)
{
    const double shortest = shortest_duration_s(j.options.profile, tau);
    std::string advice = shortest <= longest_stroke_s
                             ? fmt::format("the shortest duration that works is {} s", seconds_up(shortest))
                             : std::string("no duration up to a day works");
    if (!j.options.drop_points && tau.size() > 2)
        advice += "; or drop_points = true leaves places out";
    throw error(
        error_kind::bad_input, j.name(),
        fmt::format("the Tactile Brush cannot play {} on the grid in {} s: they follow one another too fast",
                    counted(tau.size(), "place"), seconds_down(tau.back())),
        advice);
}

/// Leaves places out until the timing is possible, and reports them.
std::vector<meeting> drop_points(const job& j, const std::vector<meeting>& points, plan& out)
{
    const std::vector<std::size_t> keep = thin_out(j.options.profile, times_of(points));
    std::vector<meeting> left;
    for (std::size_t i = 0, k = 0; i < points.size(); ++i) {
        const bool kept = k < keep.size() && keep[k] == i;
        k += kept ? 1 : 0;
        (kept ? left : out.dropped).push_back(points[i]);
    }
    if (out.dropped.empty())
        return left;
    std::string places;
    constexpr std::size_t named = 8;
    for (std::size_t i = 0; i < std::min(named, out.dropped.size()); ++i)
        places += (i == 0 ? "" : ", ") + place(out.dropped[i].position);
    out.warnings.push_back(
        fmt::format("{} of {} places on the grid left out, for which there is no time: {}{}",
                    out.dropped.size(), points.size(), places, out.dropped.size() > named ? ", ..." : ""));
    return left;
}

} // namespace

void plan_brush(const job& j, plan& out)
{
    const std::optional<grid_lines> grid = find_grid(j.tactors);
    if (!grid)
        throw error(error_kind::bad_input, fmt::format("array \"{}\"", j.tactors.name),
                    "is no rectangular grid, which the Tactile Brush needs", "use algorithm = park2016");
    std::vector<meeting> points = virtual_tactors(j, *grid);
    if (j.options.drop_points)
        points = drop_points(j, points, out);
    const std::vector<double> tau = times_of(points);
    const std::vector<double> before = parts_s(j.options.profile, tau);
    if (before.empty())
        refuse(j, tau);

    for (std::size_t i = 0; i < points.size(); ++i) {
        const double after = i + 1 < points.size() ? before[i + 1] : 0.0;
        burst b = make_burst(j, tau[i] - before[i], before[i] + after, points[i].position, tau[i]);
        b.tau_s = tau[i];
        // The last burst ends with the stroke, but the one before it may sound on for longer.
        out.total_s = std::max(out.total_s, b.onset_s + b.duration_s);
        out.bursts.push_back(std::move(b));
    }
}

} // namespace tactor::detail
