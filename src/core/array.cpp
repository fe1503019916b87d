// SPDX-License-Identifier: MIT
#include <tactor/array.hpp>

#include <algorithm>
#include <climits>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/limits.hpp"

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
        throw error(error_kind::bad_input, "grid", fmt::format("{} rows x {} columns", rows, columns),
                    fmt::format("1 to {} tactors", detail::max_channels))
            .with_field(!possible(rows)      ? "rows"
                        : !possible(columns) ? "columns"
                                             : "");
    const auto check_pitch = [](const char* field, double pitch) {
        if (!std::isfinite(pitch) || pitch <= 0.0)
            throw error(error_kind::bad_input, "grid", fmt::format("the pitch is {} mm", pitch),
                        "it must be more than 0")
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

} // namespace v0
} // namespace tactor
