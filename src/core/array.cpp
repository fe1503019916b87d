// SPDX-License-Identifier: MIT
#include <tactor/array.hpp>

#include <algorithm>
#include <climits>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "core/suggest.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// Returns the coordinates in ascending order, with those nearer than same_place_mm merged.
std::vector<double> merge_lines(std::vector<double> at)
{
    std::sort(at.begin(), at.end());
    std::vector<double> lines;
    for (const double v : at)
        if (lines.empty() || v - lines.back() > same_place_mm)
            lines.push_back(v);
    return lines;
}

// Returns the index of the line into which v was merged.
std::size_t find_line(const std::vector<double>& lines, double v)
{
    return static_cast<std::size_t>(std::upper_bound(lines.begin(), lines.end(), v) - lines.begin()) - 1;
}

[[noreturn]] void refuse(const array& a, std::size_t i, const std::string& why, std::string_view hint,
                         std::string_view field = {})
{
    const source_place& at = a.tactors[i].where;
    const std::string what = fmt::format("tactor {} {}", i, why);
    if (at.line != 0 || !at.file.empty())
        throw error(error_kind::bad_input, at, what, hint).with_field(field);
    throw error(error_kind::bad_input, "array " + detail::quoted(a.name), what, hint).with_field(field);
}

// Returns a name such as "tactor 3", with the tactor's place in its file if the place is known.
std::string other(const array& a, std::size_t i)
{
    const source_place& at = a.tactors[i].where;
    return at.line != 0 ? fmt::format("tactor {} ({})", i, at.text()) : fmt::format("tactor {}", i);
}

void check_values(const array& a, std::size_t i)
{
    const tactor_spec& t = a.tactors[i];
    const bool x_fits = std::abs(t.position.x_mm) <= detail::max_mm;
    if (!x_fits || !(std::abs(t.position.y_mm) <= detail::max_mm))
        refuse(a, i, fmt::format("is at ({}, {}) mm", t.position.x_mm, t.position.y_mm),
               "give coordinates in millimetres, within 1000000 of 0", x_fits ? "y_mm" : "x_mm");
    if (t.channel >= detail::max_channels)
        refuse(a, i, fmt::format("is on channel {}", t.channel), "give 0 to 1023: channels count from 0",
               "channel");
    if (!(t.gain_db >= detail::min_db && t.gain_db <= detail::max_gain_db))
        refuse(a, i, fmt::format("has a gain of {} dB", t.gain_db), "use -200 to 60", "gain_db");
    if (!detail::bounds_of::level_dbfs.holds(t.max_dbfs))
        refuse(a, i, fmt::format("has a limit of {} dBFS", t.max_dbfs), "use -200 to 0: 0 dBFS is full scale",
               "max_dbfs");
    for (std::size_t k = 0; k < t.thresholds.size(); ++k) {
        const threshold_point& p = t.thresholds[k];
        const bool ascends = p.hz > (k == 0 ? 0.0 : t.thresholds[k - 1].hz) && std::isfinite(p.hz);
        if (!ascends || !detail::bounds_of::level_dbfs.holds(p.dbfs))
            refuse(a, i, fmt::format("has a threshold of {} dBFS at {} Hz", p.dbfs, p.hz),
                   "use -200 to 0, in order of frequency", "thresholds");
    }
    if (t.rise_s && !(*t.rise_s > 0.0 && *t.rise_s <= 1.0))
        refuse(a, i, fmt::format("has a rise time of {} s", *t.rise_s), "use more than 0, at most 1",
               "rise_s");
    if (t.displacement_um_at_0dbfs &&
        !(*t.displacement_um_at_0dbfs > 0.0 && *t.displacement_um_at_0dbfs <= detail::max_displacement_um))
        refuse(a, i, fmt::format("has a displacement of {} um", *t.displacement_um_at_0dbfs),
               fmt::format("use more than 0, at most {}", detail::max_displacement_um),
               "displacement_um_at_0dbfs");
    if (t.threshold_dbfs && !detail::bounds_of::level_dbfs.holds(*t.threshold_dbfs))
        refuse(a, i, fmt::format("has a threshold of {} dBFS", *t.threshold_dbfs), "use -200 to 0",
               "threshold_dbfs");
    if (t.polarity != 1 && t.polarity != -1)
        refuse(a, i, fmt::format("has a polarity of {}", t.polarity), "use 1, or -1 if its wires are swapped",
               "polarity");
}

// Refuses a tactor that has the place or the channel of an earlier tactor.
void check_unique_tactor(const array& a, std::size_t i)
{
    const tactor_spec& t = a.tactors[i];
    for (std::size_t j = 0; j < i; ++j)
        if (distance_mm(a.tactors[j].position, t.position) <= same_place_mm)
            refuse(a, i,
                   fmt::format("is at ({}, {}) mm, like {}", t.position.x_mm, t.position.y_mm, other(a, j)),
                   "give each tactor its own place");
    for (std::size_t j = 0; j < i; ++j)
        if (a.tactors[j].channel == t.channel)
            refuse(a, i, fmt::format("is on channel {}, like {}", t.channel, other(a, j)),
                   "give each tactor its own channel");
}

} // namespace

unsigned array::channels() const noexcept
{
    unsigned n = 0;
    for (const tactor_spec& t : tactors)
        n = std::max(n, t.channel == UINT_MAX ? t.channel : t.channel + 1);
    return n;
}

std::optional<grid_lines> find_grid(const array& a)
{
    std::vector<double> xs;
    std::vector<double> ys;
    for (const tactor_spec& t : a.tactors) {
        if (!std::isfinite(t.position.x_mm) || !std::isfinite(t.position.y_mm))
            return std::nullopt;
        xs.push_back(t.position.x_mm);
        ys.push_back(t.position.y_mm);
    }
    grid_lines g{merge_lines(std::move(xs)), merge_lines(std::move(ys))};
    if (g.x_mm.empty() || g.x_mm.size() * g.y_mm.size() != a.tactors.size())
        return std::nullopt;

    std::vector<bool> taken(a.tactors.size());
    for (const tactor_spec& t : a.tactors) {
        const std::size_t crossing =
            find_line(g.y_mm, t.position.y_mm) * g.x_mm.size() + find_line(g.x_mm, t.position.x_mm);
        if (taken[crossing])
            return std::nullopt;
        taken[crossing] = true;
    }
    return g;
}

array make_grid(std::string name, unsigned rows, unsigned columns, double pitch_x_mm, double pitch_y_mm)
{
    const std::size_t count = std::size_t{rows} * columns;
    const auto possible = [](unsigned n) { return n >= 1 && n <= detail::max_channels; };
    if (!possible(rows) || !possible(columns) || count > detail::max_channels)
        throw error(error_kind::bad_input, "grid", fmt::format("it has {} rows x {} columns", rows, columns),
                    fmt::format("give 1 to {} tactors", detail::max_channels))
            .with_field(!possible(rows)      ? "rows"
                        : !possible(columns) ? "columns"
                                             : "");
    const auto check_pitch = [](const char* field, double pitch) {
        if (!std::isfinite(pitch) || pitch <= 0.0)
            throw error(error_kind::bad_input, "grid", fmt::format("the pitch is {} mm", pitch),
                        "give more than 0 mm")
                .with_field(field);
    };
    check_pitch("pitch_x_mm", pitch_x_mm);
    check_pitch("pitch_y_mm", pitch_y_mm);

    array a;
    a.name = std::move(name);
    a.tactors.resize(count);
    for (unsigned i = 0; i < count; ++i) {
        const unsigned row = i / columns;
        const unsigned column = i % columns;
        a.tactors[i].position = {column * pitch_x_mm, row * pitch_y_mm};
        a.tactors[i].channel = i;
    }
    return a;
}

std::optional<double> threshold_at(const tactor_spec& t, double hz)
{
    const std::vector<threshold_point>& points = t.thresholds;
    if (points.empty())
        return t.threshold_dbfs;
    const auto above =
        std::find_if(points.begin(), points.end(), [hz](const threshold_point& p) { return p.hz >= hz; });
    if (above == points.begin())
        return points.front().dbfs;
    if (above == points.end())
        return points.back().dbfs;
    const threshold_point& below = *(above - 1);
    const double part = std::log(hz / below.hz) / std::log(above->hz / below.hz);
    return std::lerp(below.dbfs, above->dbfs, part);
}

void validate(const array& a)
{
    if (a.tactors.empty() || a.tactors.size() > detail::max_channels)
        throw error(error_kind::bad_input,
                    a.where.line != 0 ? a.where.text() : "array " + detail::quoted(a.name),
                    fmt::format("it has {} tactors", a.tactors.size()),
                    fmt::format("give 1 to {}", detail::max_channels))
            .with_place(a.where)
            .with_field("tactors");

    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        check_values(a, i);
        check_unique_tactor(a, i);
    }
}

} // namespace v0
} // namespace tactor
