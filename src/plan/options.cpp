// SPDX-License-Identifier: MIT
#include "plan/options.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/plan.hpp>

#include "core/refused.hpp"
#include "core/words.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {
namespace {

/// \throws error (bad_input) for a law that no SOA can follow.
void check_profile(const timing_profile& p)
{
    const auto refuse = [](std::string_view what, double value, std::string_view hint) {
        throw error(error_kind::bad_input, "timing profile", fmt::format("{} {} cannot be", what, value),
                    hint)
            .with_field("profile");
    };
    if (!(p.slope > 0.0 && p.slope < 1.0))
        refuse("a slope of", p.slope, "between 0 and 1; 0.32 on palm and forearm");
    if (!(p.intercept_s >= 0.0 && std::isfinite(p.intercept_s)))
        refuse("an intercept in seconds of", p.intercept_s, "0 or more; 0.0473 on palm and forearm");
    if (!(p.max_soa_s > p.intercept_s && std::isfinite(p.max_soa_s)))
        refuse("a longest SOA in seconds of", p.max_soa_s,
               fmt::format("more than the intercept, {}", p.intercept_s));
}

} // namespace

double law_duration_s(const timing_profile& p, double soa_s)
{
    return std::min((soa_s - p.intercept_s) / p.slope, soa_s);
}

void check_options(const plan_options& o)
{
    if (o.algorithm == algorithm_kind::tactile_brush)
        check_profile(o.profile);
    if (o.algorithm != algorithm_kind::park2016)
        return;
    static_cast<void>(burst_duration_s(o)); // checks SOA and burst
    if (o.timing != timing_kind::fit || o.burst_s)
        return;
    const double longest = law_duration_s(o.profile, o.soa_s);
    if (!(o.min_duration_s > 0.0 && o.min_duration_s <= longest))
        throw error(error_kind::bad_input, "{timing=fit}",
                    fmt::format("bursts of at least {} cannot be had: an SOA of {} gives {}",
                                seconds_text(o.min_duration_s), seconds_text(o.soa_s), seconds_text(longest)),
                    "lower {min_duration_s}, or take a longer SOA")
            .with_field("min_duration_s");
}

plan_options apply_choices(plan_options common, const stroke_choices& c)
{
    common.algorithm = c.algorithm.value_or(common.algorithm);
    common.soa_s = c.soa_s.value_or(common.soa_s);
    common.burst_s = c.burst_s ? c.burst_s : common.burst_s;
    common.scale.level_db += c.level_db;
    common.faces = c.faces.value_or(common.faces);
    if (c.phantom) {
        common.phantom = *c.phantom;
        common.custom_phantom.reset();
    }
    return common;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {
namespace {

constexpr double shortest_burst_s = 0.0001; // under a frame at 8 kHz there would be nothing to hear
constexpr double longest_free_soa_s = 10.0;

} // namespace

double burst_duration_s(const timing_profile& p, double soa_s)
{
    detail::check_profile(p);
    if (!(soa_s > p.intercept_s && soa_s <= p.max_soa_s))
        throw detail::bad_field(
            "soa_s",
            fmt::format("{} s is out of bounds: an SOA is longer than {} s and at most {} s", soa_s,
                        p.intercept_s, p.max_soa_s),
            fmt::format("use {}", p.max_soa_s));
    return detail::law_duration_s(p, soa_s);
}

double burst_duration_s(const plan_options& o)
{
    if (!o.burst_s)
        return burst_duration_s(o.profile, o.soa_s);
    detail::check_profile(o.profile);
    if (!(o.soa_s >= shortest_burst_s && o.soa_s <= longest_free_soa_s))
        throw detail::bad_field(
            "soa_s",
            fmt::format("{} s is out of bounds: with a duration of its own for the burst an SOA is {} to "
                        "{} s",
                        o.soa_s, shortest_burst_s, longest_free_soa_s),
            fmt::format("use {}", o.profile.max_soa_s));
    if (!(*o.burst_s >= shortest_burst_s && std::isfinite(*o.burst_s)))
        throw detail::bad_field(
            "burst_s", fmt::format("{} s is no duration, {} s is the shortest", *o.burst_s, shortest_burst_s),
            fmt::format("use {} to {} s", shortest_burst_s, o.soa_s));
    if (*o.burst_s > o.soa_s)
        throw detail::bad_field(
            "burst_s",
            fmt::format("{} s is longer than the SOA of {} s, and bursts must not overlap", *o.burst_s,
                        o.soa_s),
            fmt::format("use at most {} s, or a longer SOA", o.soa_s));
    return *o.burst_s;
}

double intensity_scale::amplitude(double intensity) const
{
    // Callers refuse intensities that are negative or not numbers.
    if (!(intensity > 0.0))
        return intensity;
    if (level_db != 0.0) {
        if (!std::isfinite(level_db))
            throw detail::bad_field("level_db", fmt::format("{} is no level", level_db), "give decibels");
        return intensity_scale{kind, exponent, sl_db}.amplitude(intensity) * std::pow(10.0, level_db / 20.0);
    }
    if (kind == scale_kind::linear)
        return intensity;
    if (kind == scale_kind::stevens) {
        if (!(exponent >= 0.1 && exponent <= 3.0))
            throw detail::bad_field(
                "stevens_exponent", fmt::format("{} is not one", exponent),
                "give 0.1 to 3; 0.95 at 60 Hz and 0.6 at 250 Hz on the finger (Stevens 1968)");
        return std::pow(intensity, 1.0 / exponent);
    }
    if (!(sl_db > 0.0 && sl_db <= 100.0))
        throw error(error_kind::bad_input, "{intensity_scale}",
                    fmt::format("sl needs the sensation level of intensity 1, not {} dB", sl_db),
                    "give {sl_db} above 0 dB, such as 7")
            .with_field("intensity_scale");
    return std::pow(10.0, sl_db * (intensity - 1.0) / 20.0);
}

} // namespace v0
} // namespace tactor
