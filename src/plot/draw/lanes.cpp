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
constexpr double lowest_level = 1.6;      // for strokes below each other
constexpr double most_height = 260.0;     // of rows without a label for each, pt
constexpr std::size_t most_labelled = 64; // rows that can all get a label
constexpr double wide_pitch = 7.2;        // distance of labels, pt
constexpr double tight_pitch = 5.6;
constexpr double most_labelled_height = wide_pitch * static_cast<double>(most_labelled);
constexpr double least_space = 60.0;

std::string make_label(const array& a, const std::vector<unsigned>& tactors, bool channels)
{
    if (tactors.size() > 1)
        return fmt::format("{}-{}", tactors.front(), tactors.back());
    return channels ? fmt::format("{} ({})", tactors.front(), a.tactors[tactors.front()].channel)
                    : fmt::format("{}", tactors.front());
}

double row_middle(const lane& r)
{
    return r.top + r.height / 2.0;
}

// Returns the rows whose labels have space, from the first on.
std::vector<std::size_t> labelled(const lanes& l)
{
    std::vector<std::size_t> shown;
    double last = -l.label_pitch;
    for (std::size_t i = 0; i < l.rows.size(); ++i)
        if (const double middle = row_middle(l.rows[i]); middle - last >= l.label_pitch - 1e-9) {
            last = middle;
            shown.push_back(i);
        }
    return shown;
}

} // namespace

lanes make_lanes(const array& a, const std::vector<unsigned>& playing, double space)
{
    const auto most_rows = static_cast<std::size_t>(std::clamp(space, least_space, most_height) / lowest_row);
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

bool lanes::fit(double space)
{
    std::size_t levels = 0;
    for (const lane& r : rows)
        levels += r.levels;
    const auto even = [&](double all_pt) {
        return std::clamp(all_pt / static_cast<double>(std::max<std::size_t>(1, levels)), lowest_row,
                          highest_row);
    };
    label_pitch = wide_pitch;
    lay_out(even(rows.size() <= most_labelled ? most_labelled_height : most_height));
    if (all_height <= space && labelled(*this).size() == rows.size())
        return true;
    // Uses closer labels, and no row too low for its label.
    label_pitch = tight_pitch;
    const double most = std::min(space, most_labelled_height);
    double low = lowest_level;
    double high = highest_row;
    lay_out(low, tight_pitch);
    if (all_height > most) {
        lay_out(even(std::clamp(space, least_space, most_height)));
        return false;
    }
    for (int i = 0; i < 40; ++i) {
        const double level = (low + high) / 2.0;
        lay_out(level, tight_pitch);
        (all_height <= most ? low : high) = level;
    }
    lay_out(low, tight_pitch);
    return true;
}

void lanes::lay_out(double level, double least_row)
{
    height = level;
    std::size_t levels = 0;
    double added = 0.0;
    for (lane& r : rows) {
        const double own = level * static_cast<double>(r.levels);
        r.top = level * static_cast<double>(levels) + added;
        r.height = std::max(own, least_row);
        added += r.height - own;
        levels += r.levels;
    }
    all_height = level * static_cast<double>(levels) + added;
}

std::string draw_lane_labels(canvas& c, const lanes& l, double x, double top)
{
    const std::vector<std::size_t> shown = labelled(l);
    for (const std::size_t i : shown)
        c.text({x, top + row_middle(l.rows[i]) + cap_height(small_text) / 2.0}, l.rows[i].label,
               {.size = small_text, .anchor = align::end}, {.kind = "row-label"});
    // Rows are of one height if there is no space for all.
    return shown.size() == l.rows.size() ? "" : fmt::format("one row in {} has its number", shown[1]);
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
    const auto page_x = [&](double i) { return std::min(x_.page_from + i * column_width, x_.page_to); };
    for (std::size_t i = 0; i < columns_.size();) {
        if (columns_[i] <= 0.0) {
            ++i;
            continue;
        }
        std::vector<spot> shape{{page_x(static_cast<double>(i)), base}};
        for (; i < columns_.size() && columns_[i] > 0.0; ++i) {
            const double y = base - height * columns_[i];
            const auto k = static_cast<double>(i);
            if (smooth) {
                shape.push_back({page_x(k + 0.5), y});
            } else {
                shape.push_back({page_x(k), y});
                shape.push_back({page_x(k + 1.0), y});
            }
        }
        shape.push_back({page_x(static_cast<double>(i)), base});
        shapes.push_back(simplify(shape, 0.02));
    }
    return shapes;
}

} // namespace tactor::plot
