// SPDX-License-Identifier: MIT
#include "plot/draw/lanes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plot/draw/array_frame.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double highest_row = 11.0;
constexpr double lowest_row = 2.2;
constexpr double most_height = 260.0;     // of all rows, pt
constexpr std::size_t most_labelled = 64; // rows that all get a label
constexpr double label_pitch = 7.2;       // of labels, pt

std::string label_of(const array& a, const std::vector<unsigned>& tactors, bool channels)
{
    if (tactors.size() > 1)
        return fmt::format("{}-{}", tactors.front(), tactors.back());
    return channels ? fmt::format("{} ({})", tactors.front(), a.tactors[tactors.front()].channel)
                    : fmt::format("{}", tactors.front());
}

} // namespace

lanes make_lanes(const array& a, const std::vector<unsigned>& playing)
{
    constexpr auto most_rows = static_cast<std::size_t>(most_height / lowest_row);
    const std::size_t together = std::max<std::size_t>(1, (playing.size() + most_rows - 1) / most_rows);
    lanes l;
    l.row_of.assign(a.tactors.size(), -1);
    for (std::size_t i = 0; i < playing.size(); ++i) {
        if (i % together == 0)
            l.rows.emplace_back();
        l.rows.back().tactors.push_back(playing[i]);
        l.row_of[playing[i]] = static_cast<int>(l.rows.size()) - 1;
    }
    const bool channels = !channels_are_numbers(a);
    l.heading = channels ? "tactor (ch)" : "tactor";
    for (lane& r : l.rows) {
        r.label = label_of(a, r.tactors, channels);
        l.label_width = std::max(l.label_width, text_width(r.label, small_text));
    }
    l.label_width = std::max(l.label_width, text_width(l.heading, small_text));
    l.set_levels(std::vector<std::size_t>(l.rows.size(), 1));
    return l;
}

void lanes::set_levels(const std::vector<std::size_t>& wished)
{
    std::size_t n = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].first = n;
        rows[i].levels = wished[i];
        n += wished[i];
    }
    const double room =
        rows.size() <= most_labelled ? label_pitch * static_cast<double>(most_labelled) : most_height;
    height = std::clamp(room / static_cast<double>(std::max<std::size_t>(1, n)), lowest_row, highest_row);
}

void draw_lane_labels(canvas& c, const lanes& l, double x, double top)
{
    double last = -label_pitch;
    for (std::size_t i = 0; i < l.rows.size(); ++i) {
        const double within = l.top_of(i) + l.height_of(i) / 2.0;
        if (within - last < label_pitch - 1e-9)
            continue;
        last = within;
        const double middle = top + within;
        c.text({x, middle + cap_height(small_text) / 2.0}, l.rows[i].label,
               {.size = small_text, .anchor = align::end}, {.kind = "row-label"});
    }
}

column_profile::column_profile(const scale& x)
    : x_(x), columns_(static_cast<std::size_t>(std::ceil((x.page_to - x.page_from) / column_width)) + 1, 0.0)
{
}

void column_profile::add(double from_s, double to_s, double value)
{
    const auto column = [&](double t) {
        const double at = (x_(t) - x_.page_from) / column_width;
        return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(columns_.size() - 1)));
    };
    const std::size_t last = column(to_s);
    for (std::size_t i = column(from_s); i <= last; ++i)
        columns_[i] = std::max(columns_[i], value);
}

std::vector<std::vector<spot>> column_profile::outlines(double base, double height, bool smooth) const
{
    std::vector<std::vector<spot>> shapes;
    const auto x_of = [&](double i) { return std::min(x_.page_from + i * column_width, x_.page_to); };
    for (std::size_t i = 0; i < columns_.size();) {
        if (columns_[i] <= 0.0) {
            ++i;
            continue;
        }
        std::vector<spot> shape{{x_of(static_cast<double>(i)), base}};
        for (; i < columns_.size() && columns_[i] > 0.0; ++i) {
            const double y = base - height * columns_[i];
            const auto k = static_cast<double>(i);
            if (smooth) {
                shape.push_back({x_of(k + 0.5), y});
            } else {
                shape.push_back({x_of(k), y});
                shape.push_back({x_of(k + 1.0), y});
            }
        }
        shape.push_back({x_of(static_cast<double>(i)), base});
        shapes.push_back(simplify(shape, 0.02));
    }
    return shapes;
}

} // namespace tactor::plot
