// SPDX-License-Identifier: MIT
#include "plot/draw/lanes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "plot/draw/array_frame.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/canvas.hpp"

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

constexpr std::size_t most_starts = 60; // more are not legible
constexpr double aside = 2.0;           // distance of a number from its start

constexpr double row_height = 8.5;
constexpr double swatch = 8.0;
constexpr double gap = 3.0;           // between swatch and name
constexpr double column_gap = 10.0;   // at least, between columns
constexpr double most_of_width = 0.5; // for an entry if there are several
constexpr std::size_t most_rows = 12;

// A line of the legend: a stroke, or all its repeats.
struct entry {
    std::vector<std::size_t> numbers = {};
    std::string name = {};
};

std::vector<entry> find_entries(const scene& s, const timeline& t)
{
    std::vector<entry> all;
    for (std::size_t i = 0; i < s.strokes.size(); ++i) {
        if (t.looks[i] == all.size())
            all.push_back({{}, clean(s.strokes[i].name)});
        all[t.looks[i]].numbers.push_back(i + 1);
    }
    for (entry& e : all)
        if (e.numbers.size() > 1)
            e.name = find_repeated_name(e.name);
    return all;
}

// Returns ascending numbers as text, "1-4, 6": consecutive ones together.
std::string join_runs(const std::vector<std::size_t>& numbers)
{
    std::vector<std::string> runs;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t k = i;
        while (k + 1 < numbers.size() && numbers[k + 1] == numbers[k] + 1)
            ++k;
        runs.push_back(k == i ? fmt::format("{}", numbers[i]) : fmt::format("{}-{}", numbers[i], numbers[k]));
        i = k + 1;
    }
    return fmt::format("{}", fmt::join(runs, ", "));
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

double starts_height(const timeline& t)
{
    return t.several() ? 7.0 : 0.0;
}

std::string draw_stroke_starts(canvas& c, const timeline& t, const scale& x, double top, double bottom)
{
    if (!t.several())
        return {};
    if (t.starts_s.size() > most_starts)
        return fmt::format("starts of more than {} strokes are not marked", most_starts);
    const group g(c, {.id = "stroke-starts"});
    std::map<double, std::vector<std::size_t>> numbers; // by x
    for (std::size_t i = 0; i < t.starts_s.size(); ++i)
        numbers[std::round(x(t.starts_s[i]) * 10.0) / 10.0].push_back(i + 1);
    std::string word = "stroke "; // for the first
    double free = 0.0;
    std::size_t left_out = 0;
    for (auto i = numbers.begin(); i != numbers.end(); ++i) {
        const auto& [at, strokes] = *i;
        const double next = std::next(i) == numbers.end() ? x.page_to : std::next(i)->first;
        c.line({at, top - 8.0}, {at, bottom}, {.stroke = dark_grey, .width = 0.5, .dash = 2.0},
               {.kind = "stroke-start"});
        std::string label = join_runs(strokes);
        if (at + aside + text_width(word + label, small_text) < next)
            label = word + label;
        word.clear();
        if (at < free || at + aside + text_width(label, small_text) > x.page_to) {
            left_out += strokes.size();
            continue;
        }
        free = at + aside + text_width(label, small_text);
        c.text({at + aside, top - 3.0}, label, {.size = small_text, .ink = dark_grey, .halo = true});
    }
    return left_out == 0 ? "" : "no space for the start's number of " + counted(left_out, "stroke");
}

double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours)
{
    if (s.strokes.size() < 2)
        return 0.0;
    const group g(c, {.id = "strokes"});
    const double lead = colours ? swatch + gap : 0.0;
    double widest = 0.0;
    const std::vector<entry> entries = find_entries(s, t);
    std::vector<std::string> names;
    for (const entry& e : entries) {
        names.push_back(shorten(join_runs(e.numbers) + (e.name.empty() ? "" : " " + e.name), small_text,
                                most_of_width * where.width - lead - column_gap));
        widest = std::max(widest, text_width(names.back(), small_text));
    }
    const double entry_width = lead + widest + column_gap;
    const auto columns =
        std::max<std::size_t>(1, static_cast<std::size_t>((where.width + column_gap) / entry_width));
    const std::size_t shown = std::min(names.size(), columns * most_rows);
    const std::size_t rows = (shown + columns - 1) / columns;
    for (std::size_t i = 0; i < shown; ++i) {
        const std::size_t in_column = i / rows;
        const double x = where.x + entry_width * static_cast<double>(in_column);
        const double middle = where.y + row_height * (static_cast<double>(i % rows) + 0.5);
        if (colours)
            c.rect({x, middle - 2.5, swatch, 5.0}, {.fill = stroke_colour(i), .stroke = ink, .width = 0.3},
                   {.kind = "stroke-colour"});
        c.text(
            {x + lead, middle + cap_height(small_text) / 2.0}, names[i], {.size = small_text},
            {.kind = "stroke-name", .data = {{"stroke", fmt::format("{}", entries[i].numbers.front() - 1)}}});
    }
    double height = row_height * static_cast<double>(rows);
    std::vector<std::string> notes;
    if (shown < names.size())
        notes.push_back("and " + counted(names.size() - shown, "stroke more", "strokes more"));
    if (colours && names.size() > stroke_colours)
        notes.push_back(fmt::format("colours repeat after {} strokes", stroke_colours));
    height += draw_notes(c, notes, {where.x, where.y + height, where.width, 0.0}, 2);
    return height + 2.0;
}

} // namespace tactor::plot
