// SPDX-License-Identifier: MIT
#include "plan/course.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/trajectory/way.hpp"

namespace tactor::detail {

namespace {

/// How often a recording comes round that lies along the path: the faster the target, the oftener.
std::vector<carrier_point> texture_course(const trajectory& motion, double texture_mm)
{
    const double rounds = texture_mm > 0.0 ? motion.length_mm() / texture_mm : 1.0;
    const std::vector<way_point> way = way_over_time(motion);
    std::vector<carrier_point> course;
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
        const double hz = rounds * (way[i + 1].part - way[i].part) / (way[i + 1].t_s - way[i].t_s);
        course.push_back({way[i].t_s, hz});
        course.push_back({way[i + 1].t_s, hz});
    }
    return course;
}

/// Below it, as a part of the frequency, a bend is the last digits.
constexpr double last_digits = 1e-12;

/// Where the target rests, its carrier stays. Between two points of its way at which it is faster or slower
/// there is a third, with the frequency that makes the cycles until the next what they are: so nothing adds
/// up, however long the stroke.
std::vector<carrier_point> profile_course(const trajectory& motion, const std::vector<carrier_part>& profile)
{
    std::vector<double> parts;
    for (const carrier_part& p : profile)
        parts.push_back(p.part);
    const std::vector<way_point> way = way_over_time(motion, parts);
    const auto [lowest, highest] =
        std::minmax_element(profile.begin(), profile.end(),
                            [](const carrier_part& a, const carrier_part& b) { return a.hz < b.hz; });
    std::vector<carrier_point> course{{0.0, hz_at(profile, way.front().part)}};
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
        const way_point& from = way[i];
        const way_point& to = way[i + 1];
        const double from_hz = course.back().hz;
        const double to_hz = hz_at(profile, to.part);
        const double straight_hz = std::midpoint(from_hz, to_hz);
        const double mean_hz = hz_at(profile, to.mean);
        if (std::abs(mean_hz - straight_hz) > last_digits * straight_hz)
            course.push_back({std::midpoint(from.t_s, to.t_s),
                              std::clamp(2.0 * mean_hz - straight_hz, lowest->hz, highest->hz)});
        course.push_back({to.t_s, to_hz});
    }
    return course;
}

void check_profile(const std::vector<carrier_part>& profile)
{
    double before = -1.0;
    for (const carrier_part& p : profile) {
        if (!(p.part >= 0.0 && p.part <= 1.0 && p.part > before))
            throw detail::bad_field("carrier_profile",
                                    fmt::format("the part {} is out of order or range", p.part),
                                    "give parts of the path from 0 to 1, ascending");
        if (!(p.hz >= 1.0 && p.hz <= 384000.0))
            throw detail::bad_field("carrier_profile", fmt::format("{} Hz is not a carrier", p.hz),
                                    "give 1 to 384000 Hz");
        before = p.part;
    }
}

} // namespace

double hz_at(const std::vector<carrier_part>& profile, double part)
{
    const auto above =
        std::find_if(profile.begin(), profile.end(), [part](const carrier_part& p) { return p.part > part; });
    if (above == profile.begin())
        return above->hz;
    const carrier_part& below = *(above - 1);
    if (above == profile.end())
        return below.hz;
    return std::lerp(below.hz, above->hz, (part - below.part) / (above->part - below.part));
}

std::vector<carrier_point> course_of(const stroke& s, const waveform& w)
{
    check_profile(s.carrier_profile);
    if (w.kind == waveform_kind::recording && w.texture == texture_kind::length)
        return texture_course(s.motion, w.texture_mm);
    if (!s.carrier_profile.empty())
        return profile_course(s.motion, s.carrier_profile);
    return {};
}

} // namespace tactor::detail
