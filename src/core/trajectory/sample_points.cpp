// SPDX-License-Identifier: MIT
#include "core/trajectory/sample_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "core/access.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::detail {
namespace {

// Half of what is promised: between the places that are looked at it may be a little more.
constexpr double tolerance_mm = 0.005;
constexpr double tolerance_intensity = 0.002;
constexpr double shortest_s = 1e-4;

// Returns points at the times and between them, halving each stretch that is not straight.
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
                            fmt::format("it takes more than {} timed points", most_sampled_points),
                            "make it shorter or simpler");
        }
    }
    return points;
}

// Returns the times between which the movement is smooth, ascending, from 0 to the duration.
std::vector<double> find_smooth_times(const trajectory::impl& i, const drawn_path& law)
{
    std::vector<double> times{0.0, i.duration_s};
    if (law.way.length_mm() > 0.0)
        times = i.vertices();
    if (law.moves) {
        for (const double t : law.moves->bends())
            times.push_back(i.from_own(t, law.moves->total_s()));
        for (const profile_point& p : law.moves->given().intensity)
            times.push_back(i.from_own(law.moves->arrival_s(p.part), law.moves->total_s()));
    }
    std::sort(times.begin(), times.end());
    times.front() = 0.0;
    times.back() = i.duration_s;
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

} // namespace

std::vector<timed_point> sample_points(const trajectory& t)
{
    const trajectory::impl& i = access::of(t);
    if (const auto* law = std::get_if<drawn_path>(&i.law))
        return sample_between(t, find_smooth_times(i, *law));
    const auto& law = std::get<timed_points>(i.law);
    std::vector<timed_point> points = *law.points;
    for (timed_point& p : points) {
        p.t_s = i.from_own(p.t_s, law.duration_s());
        p.intensity *= i.gain;
    }
    return points;
}

} // namespace tactor::detail
