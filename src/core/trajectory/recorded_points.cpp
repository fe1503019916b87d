// SPDX-License-Identifier: MIT
#include "core/trajectory/recorded_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"

namespace tactor::detail {
namespace {

/// Greatest distance of a time from zero, s. Seconds since 1970 are about 1.8e9. Beyond this limit a double
/// cannot resolve microseconds.
constexpr double farthest_time_s = 1e10;
constexpr std::size_t most_points = 10'000'000;
constexpr double edge_of_gap_s = 1e-6;

} // namespace

recorded_points::recorded_points(double intensity_max, find_place where, std::string_view unit)
    : intensity_max_(intensity_max), where_(std::move(where)), unit_(unit)
{
    if (!bounds_of::intensity_max.holds(intensity_max))
        throw bad_field("intensity_max", fmt::format("{:g} is out of range for intensity 1", intensity_max),
                        fmt::format("give {:.9g} to {:.9g}, such as 255", bounds_of::intensity_max.low,
                                    bounds_of::intensity_max.high));
}

std::string recorded_points::here() const
{
    return where_ ? where_(recorded::row).text() : fmt::format("point {}", added_);
}

void recorded_points::note(oddity& o)
{
    if (o.count++ == 0)
        o.first = here();
}

void recorded_points::refuse(recorded value, std::string_view why, std::string_view hint) const
{
    if (where_)
        throw error(error_kind::bad_input, where_(value), why, hint);
    throw error(error_kind::bad_input, value == recorded::row ? "timed points" : here(), why, hint);
}

void recorded_points::check(const timed_point& p) const
{
    const auto within = [this](recorded value, std::string_view name, double v, double most) {
        if (!(std::abs(v) <= most))
            refuse(value, fmt::format("{} {}", name, v), fmt::format("give {:g} to {:g}", -most, most));
    };
    within(recorded::t_s, "t_s", p.t_s, farthest_time_s);
    within(recorded::x_mm, "x_mm", p.position.x_mm, max_mm);
    within(recorded::y_mm, "y_mm", p.position.y_mm, max_mm);
    if (!(p.intensity >= 0.0))
        refuse(recorded::intensity, fmt::format("intensity {} is below 0", p.intensity), "give 0 or more");
    if (p.intensity > intensity_max_)
        refuse(recorded::intensity,
               fmt::format("intensity {} is above {:g}, the requested level", p.intensity, intensity_max_),
               "name the value that means 1: {intensity_max=100} for per cent, {intensity_max=127} for MIDI, "
               "{intensity_max=255} for 8 bits");
}

double recorded_points::subtract_first_time(double t_s)
{
    if (points_.empty())
        first_time_s_ = t_s;
    const double t = t_s - first_time_s_;
    // Compares times after subtraction: two times far from zero may differ but give the same difference.
    if (!points_.empty() && t < points_.back().t_s)
        refuse(recorded::t_s,
               fmt::format("time {} s is before that of the previous {}, {} s", t_s, unit_, last_time_s_),
               "put times in ascending order");
    if (t > longest_stroke_s)
        refuse(recorded::t_s, fmt::format("time {} s is {} s after the first {}", t_s, t, unit_),
               fmt::format("use at most {:g} s", longest_stroke_s));
    last_time_s_ = t_s;
    return t;
}

void recorded_points::add(const timed_point& p)
{
    ++added_;
    if (std::isnan(p.position.x_mm) || std::isnan(p.position.y_mm) || std::isnan(p.intensity)) {
        in_gap_ = true;
        note(gaps_);
        return;
    }
    check(p);
    add_after_gap({subtract_first_time(p.t_s), p.position, p.intensity / intensity_max_});
}

// Adds the first point after a gap. In the gap the touch is lifted, from the last place before it to this
// place.
void recorded_points::add_after_gap(const timed_point& p)
{
    if (std::exchange(in_gap_, false) && !points_.empty() && p.t_s > points_.back().t_s) {
        const timed_point last = points_.back();
        const double edge_s = std::min(edge_of_gap_s, (p.t_s - last.t_s) / 4.0);
        append({last.t_s + edge_s, last.position, 0.0});
        append({p.t_s - edge_s, p.position, 0.0});
    }
    append(p);
}

// Adds a point, which replaces an earlier point of the same time. Touch screens report several places with
// the same time; the finger is at the last one.
void recorded_points::append(const timed_point& p)
{
    if (!points_.empty() && p.t_s == points_.back().t_s) {
        points_.back() = p;
        note(repeated_);
        return;
    }
    if (points_.size() == most_points)
        refuse(recorded::row, fmt::format("there are more than {} points", most_points),
               "leave some out, or split the recording");
    points_.push_back(p);
}

void recorded_points::warn()
{
    if (gaps_.count != 0)
        warnings_.push_back(fmt::format("{}: no place (nan) in {}: the finger is lifted there", gaps_.first,
                                        gaps_.count == 1
                                            ? fmt::format("this {}", unit_)
                                            : fmt::format("{} from here on", counted(gaps_.count, unit_))));
    if (repeated_.count == 1)
        warnings_.push_back(fmt::format("{}: it has the same time as the previous {}; only the last counts",
                                        repeated_.first, unit_));
    if (repeated_.count > 1)
        warnings_.push_back(
            fmt::format("{}: it has the same time as the previous {}, and so do {} {}s in all; "
                        "only the last of equal times counts",
                        repeated_.first, unit_, repeated_.count, unit_));
}

std::vector<timed_point> recorded_points::take()
{
    if (points_.size() < 2)
        refuse(recorded::row,
               fmt::format("a stroke needs at least 2 points{}, but this one has {}",
                           repeated_.count != 0 ? " with different times" : "", points_.size()),
               "give the start and the end of the stroke");
    warn();
    return std::move(points_);
}

} // namespace tactor::detail
