// SPDX-License-Identifier: MIT
#include "session/walk.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tactor::session {
namespace {

// Duration that everybody feels. The pauses distinguish the bursts from a fault that hums.
constexpr double burst_s = 0.15;
constexpr double onset_s = 0.25;
constexpr unsigned bursts = 3;

std::string describe_channel(const array& a, std::size_t tactor)
{
    return fmt::format("tactor {} (channel {})", tactor, a.tactors[tactor].channel);
}

} // namespace

plan walk_plan(const array& a, unsigned tactor, double carrier_hz)
{
    plan p;
    p.algorithm = "walk";
    p.carrier_hz = carrier_hz;
    for (unsigned i = 0; i < bursts; ++i) {
        burst b;
        b.onset_s = i * onset_s;
        b.duration_s = burst_s;
        b.position = a.tactors[tactor].position;
        b.drives = {{tactor, 1.0}};
        p.bursts.push_back(std::move(b));
    }
    p.total_s = p.bursts.back().onset_s + burst_s;
    p.stroke_duration_s = p.total_s;
    return p;
}

std::vector<placed_plan> walk_plans(const array& a, double carrier_hz)
{
    std::vector<placed_plan> all;
    for (unsigned i = 0; i < a.tactors.size(); ++i)
        all.push_back({walk_plan(a, i, carrier_hz)});
    return all;
}

walk_map map_channels(const array& a, const walk_answers& felt)
{
    walk_map v;
    std::vector<std::vector<std::size_t>> driven(
        a.tactors.size()); // tactors that were driven when this one was felt
    for (std::size_t i = 0; i < felt.size(); ++i)
        if (felt[i])
            driven[*felt[i]].push_back(i);
        else
            v.problems.push_back(fmt::format("{} was not felt", describe_channel(a, i)));
    for (std::size_t place = 0; place < driven.size(); ++place) {
        if (driven[place].size() < 2)
            continue;
        std::vector<std::string> names;
        for (const std::size_t i : driven[place])
            names.push_back(describe_channel(a, i));
        v.problems.push_back(fmt::format("{} were felt at one place, {}", fmt::join(names, " and "), place));
    }
    if (!v.problems.empty())
        return v;
    for (std::size_t place = 0; place < driven.size(); ++place) {
        v.channels.push_back(a.tactors[driven[place].front()].channel);
        v.changed = v.changed || driven[place].front() != place;
    }
    return v;
}

detail::box find_bounds(const array& a)
{
    std::vector<point> places;
    for (const tactor_spec& t : a.tactors)
        places.push_back(t.position);
    return detail::bounding_box(places);
}

std::string tactor_map_text(const array& a)
{
    constexpr double widest = 74.0; // columns
    constexpr double mm_per_column = 2.5;
    const auto [low, high] = find_bounds(a);
    // A character is about twice as tall as wide.
    const double scale = std::max(mm_per_column, (high.x_mm - low.x_mm) / widest);
    const auto cells = [](double v) { return static_cast<std::size_t>(std::lround(v)); };
    std::vector<std::string> rows(cells((high.y_mm - low.y_mm) / (2.0 * scale)) + 1);
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const point p = a.tactors[i].position;
        std::string& row = rows[cells((p.y_mm - low.y_mm) / (2.0 * scale))];
        const std::size_t column = 2 + cells((p.x_mm - low.x_mm) / scale);
        const std::string number = fmt::format("{}", i);
        row.resize(std::max(row.size(), column + number.size()), ' ');
        row.replace(column, number.size(), number);
    }
    return fmt::format("{}\n", fmt::join(rows, "\n"));
}

} // namespace tactor::session
