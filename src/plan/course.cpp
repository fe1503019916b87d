// SPDX-License-Identifier: MIT
#include "plan/job.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>

#include <boost/math/quadrature/gauss.hpp>
#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/refused.hpp"
#include "core/trajectory/spans.hpp"

namespace tactor::detail {

namespace {

/// Returns the rate at which a recording along the path repeats. It rises with the target's speed.
std::vector<carrier_point> texture_course(const trajectory& motion, double texture_mm)
{
    const double rounds = texture_mm > 0.0 ? motion.length_mm() / texture_mm : 1.0;
    const std::vector<progress_point> way = progress_over_time(motion);
    std::vector<carrier_point> course;
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
        const double hz = rounds * (way[i + 1].part - way[i].part) / (way[i + 1].t_s - way[i].t_s);
        course.push_back({way[i].t_s, hz});
        course.push_back({way[i + 1].t_s, hz});
    }
    return course;
}

/// Bend, relative to the frequency, below which it is only a rounding error.
constexpr double last_digits = 1e-12;

/// Greatest error of the phase between two points, and a rounding error of the frequency that is always
/// accepted.
constexpr double phase_error = 1e-11; // cycles
constexpr double rounding = 2e-14;    // relative to the frequency
/// Greatest number of carrier cycles between two points of a bent course. With more cycles, a double cannot
/// resolve 1e-10 of a cycle.
constexpr double most_cycles = 4096.0;
constexpr int most_halvings = 12;

/// Frequency between two points, as a function of the part of time u, from 0 to 1.
using frequency = std::function<double(double u)>;

/// Returns the bend of a polynomial of degree 5 that interpolates the frequency at both ends and at four
/// Chebyshev nodes between them. A last term then corrects the polynomial's mean to the mean frequency.
std::array<double, 4> find_bend(const frequency& hz, double from_hz, double to_hz)
{
    constexpr std::array<double, 4> places{0.0954915028125263, 0.3454915028125263, 0.6545084971874737,
                                           0.9045084971874737};
    std::array<double, 4> v{};
    double most = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        const double u = places[i];
        const double off = hz(u) - std::lerp(from_hz, to_hz, u);
        most = std::max(most, std::abs(off));
        v[i] = off / (u * (1.0 - u));
    }
    if (!(most > last_digits * std::max(from_hz, to_hz)))
        return {};
    // Newton's divided differences, then the coefficients of 1, u, u^2, u^3.
    for (std::size_t order = 1; order < 4; ++order)
        for (std::size_t i = 3; i >= order; --i)
            v[i] = (v[i] - v[i - 1]) / (places[i] - places[i - order]);
    std::array<double, 4> bend{};
    for (std::size_t i = 4; i-- > 0;) {
        for (std::size_t k = 3; k > 0; --k)
            bend[k] = bend[k - 1] - places[i] * bend[k];
        bend[0] = v[i] - places[i] * bend[0];
    }
    const double mean = boost::math::quadrature::gauss<double, 7>::integrate(hz, 0.0, 1.0);
    const double own =
        std::midpoint(from_hz, to_hz) + bend[0] / 6.0 + bend[1] / 12.0 + bend[2] / 20.0 + bend[3] / 30.0;
    bend[1] += 30.0 * (mean - own); // 30 u^2 (1 - u)^2 has the mean 1
    bend[2] -= 30.0 * (mean - own);
    return bend;
}

/// Adds points after the last point of the course, up to `to`, as many as the frequency needs.
void add_course_points(std::vector<carrier_point>& course, const frequency& hz, carrier_point to,
                       int halvings = 0)
{
    carrier_point& from = course.back();
    from.bend = find_bend(hz, from.hz, to.hz);
    const double time_s = to.t_s - from.t_s;
    const double high_hz = std::max(from.hz, to.hz);
    double off = 0.0;
    if (from.bend != carrier_point{}.bend)
        for (const double u : {0.03, 0.2, 0.5, 0.8, 0.97})
            off = std::max(off, std::abs(hz(u) - hz_between(from, to, u)));
    const bool precise = off * time_s <= phase_error || off <= rounding * high_hz;
    const bool short_enough = from.bend == carrier_point{}.bend || time_s * high_hz <= most_cycles;
    if ((precise && short_enough) || halvings == most_halvings) {
        course.push_back(to);
        return;
    }
    const carrier_point middle{std::midpoint(from.t_s, to.t_s), hz(0.5)};
    add_course_points(
        course, [&hz](double u) { return hz(0.5 * u); }, middle, halvings + 1);
    add_course_points(
        course, [&hz](double u) { return hz(0.5 + 0.5 * u); }, to, halvings + 1);
}

/// Returns the carrier of a profile. It stays constant while the target rests.
std::vector<carrier_point> profile_course(const trajectory& motion, const std::vector<carrier_part>& profile)
{
    std::vector<double> parts;
    for (const carrier_part& p : profile)
        parts.push_back(p.part);
    const smooth_progress way = find_smooth_progress(motion, parts);
    std::vector<carrier_point> course{{0.0, hz_at(profile, way.points.front().part)}};
    for (std::size_t i = 0; i + 1 < way.points.size(); ++i) {
        const progress_point& to = way.points[i + 1];
        add_course_points(course, [&](double u) { return hz_at(profile, way.part(i, u)); },
                          {to.t_s, hz_at(profile, to.part)});
    }
    return course;
}

/// Returns the carrier over time, from 0 on.
std::vector<carrier_point> times_course(const std::vector<carrier_time>& times)
{
    std::vector<carrier_point> course;
    if (times.front().t_s > 0.0)
        course.push_back({0.0, times.front().hz});
    for (const carrier_time& p : times) {
        if (!(p.t_s >= (course.empty() ? 0.0 : course.back().t_s) && p.t_s <= longest_stroke_s))
            throw detail::bad_field("carrier_hz", fmt::format("time {} s is out of order or range", p.t_s),
                                    "give times in seconds from 0, ascending");
        if (!bounds_of::carrier_hz.holds(p.hz))
            throw detail::bad_field("carrier_hz", fmt::format("{} Hz is not a carrier", p.hz),
                                    "give 1 to 384000 Hz");
        course.push_back({p.t_s, p.hz});
    }
    return course;
}

void check_profile(const std::vector<carrier_part>& profile)
{
    double before = -1.0;
    for (const carrier_part& p : profile) {
        if (!(bounds_of::part.holds(p.part) && p.part > before))
            throw detail::bad_field("carrier_profile",
                                    fmt::format("part {} is out of order or range", p.part),
                                    "give parts of the path from 0 to 1, ascending");
        if (!bounds_of::carrier_hz.holds(p.hz))
            throw detail::bad_field("carrier_profile", fmt::format("{} Hz is not a carrier", p.hz),
                                    "give 1 to 384000 Hz");
        before = p.part;
    }
}

} // namespace

double hz_at(const std::vector<carrier_part>& profile, double part)
{
    const auto above = std::upper_bound(profile.begin(), profile.end(), part,
                                        [](double v, const carrier_part& p) { return v < p.part; });
    if (above == profile.begin())
        return above->hz;
    const carrier_part& below = *(above - 1);
    if (above == profile.end())
        return below.hz;
    return std::lerp(below.hz, above->hz, (part - below.part) / (above->part - below.part));
}

double hz_between(const carrier_point& from, const carrier_point& to, double u)
{
    const std::array<double, 4>& b = from.bend;
    const double straight = std::lerp(from.hz, to.hz, u);
    return straight + u * (1.0 - u) * (b[0] + u * (b[1] + u * (b[2] + u * b[3])));
}

std::vector<carrier_point> make_course(const stroke& s, const waveform& w)
{
    check_profile(s.sound.carrier_profile);
    if (w.kind == waveform_kind::recording && w.texture == texture_kind::length)
        return texture_course(s.motion, w.texture_mm);
    if (!s.sound.carrier_times.empty())
        return times_course(s.sound.carrier_times);
    if (!s.sound.carrier_profile.empty())
        return profile_course(s.motion, s.sound.carrier_profile);
    return {};
}

} // namespace tactor::detail
