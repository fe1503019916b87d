// SPDX-License-Identifier: MIT
#include "plot/draw/lanes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plot/draw/array_frame.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double lowest_level = 2.2;
constexpr double most_height = 460.0; // of rows that all get a label, pt
constexpr double most_unlabelled = 260.0;
constexpr double label_pitch = 5.6; // least distance of labels, pt
constexpr double least_space = 60.0;

std::string make_label(const array& a, const std::vector<unsigned>& tactors, bool channels)
{
    if (tactors.size() > 1)
        return fmt::format("{}-{}", tactors.front(), tactors.back());
    return channels ? fmt::format("{} ({})", tactors.front(), a.tactors[tactors.front()].channel)
                    : fmt::format("{}", tactors.front());
}

} // namespace

lanes make_lanes(const array& a, const std::vector<unsigned>& playing, double space)
{
    const auto most_rows =
        static_cast<std::size_t>(std::clamp(space, least_space, most_unlabelled) / lowest_level);
    const std::size_t together = std::max<std::size_t>(1, (playing.size() + most_rows - 1) / most_rows);
    lanes l;
    l.row_by_tactor.assign(a.tactors.size(), -1);
    for (std::size_t i = 0; i < playing.size(); ++i) {
        if (i % together == 0)
            l.rows.emplace_back();
        l.rows.back().tactors.push_back(playing[i]);
        l.row_by_tactor[playing[i]] = static_cast<int>(l.rows.size()) - 1;
    }
    const bool channels = !channels_are_numbers(a);
    l.heading = channels ? "tactor (ch)" : "tactor";
    for (lane& r : l.rows) {
        r.label = make_label(a, r.tactors, channels);
        l.label_width = std::max(l.label_width, text_width(r.label, small_text));
    }
    l.label_width = std::max(l.label_width, text_width(l.heading, small_text));
    l.fit(space);
    return l;
}

bool lanes::fit(double space, double highest)
{
    const auto all = static_cast<double>(std::max<std::size_t>(1, rows.size() * levels));
    height = std::clamp(std::min(space, most_height) / all, lowest_level, highest);
    return all_height() <= space + 1e-9;
}

std::string draw_lane_labels(canvas& c, const lanes& l, double x, double top)
{
    const auto stride =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(label_pitch / l.row_height() - 1e-9)));
    for (std::size_t i = 0; i < l.rows.size(); i += stride)
        c.text({x, top + l.top(i) + (l.row_height() + cap_height(small_text)) / 2.0}, l.rows[i].label,
               {.size = small_text, .anchor = align::end}, {.kind = "row-label"});
    return stride == 1 || l.rows.size() < 2 ? "" : fmt::format("one row in {} has its number", stride);
}

std::vector<std::vector<spot>> outline(const std::vector<column_range>& columns, const scale& x,
                                       const scale& y)
{
    std::vector<std::vector<spot>> shapes;
    const auto page_x = [&](double at) { return std::min(x(at), x.page_to); };
    const auto is_zero = [&](std::size_t i) { return columns[i].low == 0.0F && columns[i].high == 0.0F; };
    for (std::size_t i = 0; i < columns.size();) {
        if (is_zero(i)) {
            ++i;
            continue;
        }
        std::vector<spot> above{{page_x(static_cast<double>(i)), y(0.0)}};
        std::vector<spot> below = above;
        for (; i < columns.size() && !is_zero(i); ++i) {
            above.push_back({page_x(static_cast<double>(i) + 0.5), y(columns[i].high)});
            below.push_back({above.back().x, y(columns[i].low)});
        }
        above.push_back({page_x(static_cast<double>(i)), y(0.0)});
        below.push_back(above.back());
        std::vector<spot>& shape = shapes.emplace_back(simplify(above, 0.02));
        const std::vector<spot> lower = simplify(below, 0.02);
        if (lower.size() > 2) // else it is the line of 0
            shape.insert(shape.end(), lower.rbegin(), lower.rend());
    }
    return shapes;
}

} // namespace tactor::plot
