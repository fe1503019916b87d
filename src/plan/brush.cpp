// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/limits.hpp"
#include "core/words.hpp"
#include "plan/brush.hpp"
#include "plan/job.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {
namespace {

std::vector<double> meeting_times(const std::vector<meeting>& points)
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
        advice += "; or {drop_points=true} leaves places out";
    throw error(
        error_kind::bad_input, j.name(),
        fmt::format("the Tactile Brush cannot play {} on the grid in {} s: they follow one another too fast",
                    counted(tau.size(), "place"), seconds_down(tau.back())),
        advice);
}

/// Leaves places out until the timing is possible, and reports them.
std::vector<meeting> drop_points(const job& j, const std::vector<meeting>& points, plan& out)
{
    const std::vector<std::size_t> keep = thin_out(j.options.profile, meeting_times(points));
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

// A part that is negative by a rounding error is none.
constexpr double slack_s = 1e-10;

bool possible(double part_s)
{
    return part_s >= -slack_s;
}

/// Returns the interior virtual tactors in the order in which they go: the one with the smallest gap, the
/// first of equals.
std::vector<std::size_t> order_of_going(const std::vector<double>& tau_s)
{
    const std::size_t n = tau_s.size();
    std::vector<std::size_t> before(n);
    std::vector<std::size_t> after(n);
    std::set<std::pair<long long, std::size_t>> by_gap;
    // Whole nanoseconds, so that equal gaps tie.
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

/// Returns the places, ascending, that remain of n when the first `gone` of `order` have gone.
std::vector<std::size_t> remaining_after(std::size_t n, const std::vector<std::size_t>& order,
                                         std::size_t gone)
{
    std::vector<bool> out(n, false);
    for (std::size_t k = 0; k < gone; ++k)
        out[order[k]] = true;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < n; ++i)
        if (!out[i])
            places.push_back(i);
    return places;
}

} // namespace

void plan_brush(const job& j, plan& out)
{
    const std::optional<grid_lines> grid = find_grid(j.tactors);
    if (!grid)
        throw error(error_kind::bad_input, fmt::format("array \"{}\"", j.tactors.name),
                    "is no rectangular grid, which the Tactile Brush needs", "use {algorithm=park2016}")
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
        // The last burst ends with the stroke, but the one before it may sound on for longer.
        out.total_s = std::max(out.total_s, b.onset_s + b.duration_s);
        out.bursts.push_back(std::move(b));
    }
}

double next_part_s(const timing_profile& p, double gap_s, double part_s)
{
    return (gap_s - p.intercept_s + (1.0 - p.slope) * part_s) / (1.0 + p.slope);
}

std::vector<double> parts_s(const timing_profile& p, const std::vector<double>& tau_s)
{
    std::vector<double> parts{0.0};
    for (std::size_t i = 1; i < tau_s.size(); ++i) {
        const double part = next_part_s(p, tau_s[i] - tau_s[i - 1], parts.back());
        if (!possible(part))
            return {};
        parts.push_back(std::max(part, 0.0));
    }
    return parts;
}

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

std::vector<std::size_t> thin_out(const timing_profile& p, const std::vector<double>& tau_s)
{
    const std::vector<std::size_t> order = order_of_going(tau_s);
    const auto works = [&](std::size_t gone) {
        std::vector<double> tau;
        for (const std::size_t i : remaining_after(tau_s.size(), order, gone))
            tau.push_back(tau_s[i]);
        return !parts_s(p, tau).empty();
    };
    // When a place goes, the part of the next grows by (2 slope part + intercept) / (1 + slope), with the
    // part of the one that went. No part is below -intercept / (2 slope), so that is never negative: what
    // works with some gone works with more gone.
    std::size_t few = 0;
    std::size_t many = order.size();
    while (few < many) {
        const std::size_t half = few + (many - few) / 2;
        if (works(half))
            many = half;
        else
            few = half + 1;
    }
    return remaining_after(tau_s.size(), order, many);
}

} // namespace tactor::detail
