// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include <tactor/array.hpp>

#include "core/limits.hpp"
#include "core/suggest.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::max_mm;

[[noreturn]] void refuse(const array& a, std::size_t i, const std::string& why, std::string_view hint,
                         std::string_view field = {})
{
    const source_place& at = a.tactors[i].where;
    const std::string what = fmt::format("tactor {} {}", i, why);
    if (at.line != 0 || !at.file.empty())
        throw error(error_kind::bad_input, at, what, hint).with_field(field);
    throw error(error_kind::bad_input, "array " + detail::quoted(a.name), what, hint).with_field(field);
}

// Returns "tactor 3", with its place in the file if it has one.
std::string other(const array& a, std::size_t i)
{
    const source_place& at = a.tactors[i].where;
    return at.line != 0 ? fmt::format("tactor {} ({})", i, at.text()) : fmt::format("tactor {}", i);
}

void check_values(const array& a, std::size_t i)
{
    const tactor_spec& t = a.tactors[i];
    const bool x_fits = std::abs(t.position.x_mm) <= max_mm;
    if (!x_fits || !(std::abs(t.position.y_mm) <= max_mm))
        refuse(a, i, fmt::format("is at ({}, {}) mm", t.position.x_mm, t.position.y_mm),
               "coordinates are millimetres, within 1000000 of 0", x_fits ? "y_mm" : "x_mm");
    if (t.channel >= detail::max_channels)
        refuse(a, i, fmt::format("is on channel {}", t.channel), "channels count from 0", "channel");
    if (!(t.gain_db >= detail::min_db && t.gain_db <= detail::max_gain_db))
        refuse(a, i, fmt::format("has a gain of {} dB", t.gain_db), "allowed: -200 to 60", "gain_db");
    if (!(t.max_dbfs >= detail::min_db && t.max_dbfs <= 0.0))
        refuse(a, i, fmt::format("has a limit of {} dBFS", t.max_dbfs),
               "0 dBFS is full scale; allowed: -200 to 0", "max_dbfs");
    for (std::size_t k = 0; k < t.thresholds.size(); ++k) {
        const threshold_point& p = t.thresholds[k];
        const bool ascends = p.hz > (k == 0 ? 0.0 : t.thresholds[k - 1].hz) && std::isfinite(p.hz);
        if (!ascends || !(p.dbfs >= detail::min_db && p.dbfs <= 0.0))
            refuse(a, i, fmt::format("has a threshold of {} dBFS at {} Hz", p.dbfs, p.hz),
                   "allowed: -200 to 0, in order of frequency", "thresholds");
    }
    if (t.rise_s && !(*t.rise_s > 0.0 && *t.rise_s <= 1.0))
        refuse(a, i, fmt::format("has a rise time of {} s", *t.rise_s), "allowed: above 0 to 1", "rise_s");
    if (t.displacement_um_at_0dbfs &&
        !(*t.displacement_um_at_0dbfs > 0.0 && *t.displacement_um_at_0dbfs <= detail::max_displacement_um))
        refuse(a, i, fmt::format("has a displacement of {} um", *t.displacement_um_at_0dbfs),
               fmt::format("allowed: above 0 to {}", detail::max_displacement_um),
               "displacement_um_at_0dbfs");
    if (t.threshold_dbfs && !(*t.threshold_dbfs >= detail::min_db && *t.threshold_dbfs <= 0.0))
        refuse(a, i, fmt::format("has a threshold of {} dBFS", *t.threshold_dbfs), "allowed: -200 to 0",
               "threshold_dbfs");
    if (t.polarity != 1 && t.polarity != -1)
        refuse(a, i, fmt::format("has a polarity of {}", t.polarity),
               "1, or -1 where it is wired the other way round", "polarity");
}

// Refuses a tactor that is where an earlier one is, or on its channel.
void check_own(const array& a, std::size_t i)
{
    const tactor_spec& t = a.tactors[i];
    for (std::size_t j = 0; j < i; ++j)
        if (distance_mm(a.tactors[j].position, t.position) <= same_place_mm)
            refuse(a, i,
                   fmt::format("is at ({}, {}) mm, the place of {}", t.position.x_mm, t.position.y_mm,
                               other(a, j)),
                   "give each tactor a place of its own");
    for (std::size_t j = 0; j < i; ++j)
        if (a.tactors[j].channel == t.channel)
            refuse(a, i, fmt::format("is on channel {}, that of {}", t.channel, other(a, j)),
                   "give each tactor a channel of its own");
}

} // namespace

void validate(const array& a)
{
    if (a.tactors.empty() || a.tactors.size() > detail::max_channels)
        throw error(error_kind::bad_input,
                    a.where.line != 0 ? a.where.text() : "array " + detail::quoted(a.name),
                    fmt::format("{} tactors", a.tactors.size()),
                    fmt::format("an array has 1 to {}", detail::max_channels))
            .with_place(a.where)
            .with_field("tactors");

    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        check_values(a, i);
        check_own(a, i);
    }
}

} // namespace v0
} // namespace tactor
