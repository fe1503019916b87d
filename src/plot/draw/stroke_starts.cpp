// SPDX-License-Identifier: MIT
#include "plot/draw/stroke_starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_starts = 60; // more are not legible
constexpr std::size_t most_lines = 3;   // of numbers
constexpr double line_height = 7.0;
constexpr double aside = 2.0; // distance of a number from its start

using numbers_at = std::map<double, std::vector<std::size_t>>; // by x

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

std::vector<std::string> write_entries(const std::vector<entry>& entries)
{
    std::vector<std::string> all;
    for (const entry& e : entries)
        all.push_back(e.name.empty() ? join_runs(e.numbers)
                                     : fmt::format("{} {}", join_runs(e.numbers), e.name));
    return all;
}

// Shortens names; shortens them in the middle if their beginnings are the same.
std::vector<std::string> shortened(const std::vector<std::string>& all, double width)
{
    std::vector<std::string> cut;
    std::set<std::string> seen;
    bool alike = false;
    for (const std::string& n : all) {
        cut.push_back(shorten(n, small_text, width));
        const bool first = seen.insert(cut.back().substr(cut.back().find(' ') + 1)).second;
        alike = alike || (!first && cut.back() != n);
    }
    for (std::size_t i = 0; alike && i < all.size(); ++i)
        cut[i] = shorten_middle(all[i], small_text, width);
    return cut;
}

} // namespace

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

stroke_starts find_starts(const timeline& t, const scale& x)
{
    stroke_starts all;
    if (!t.several())
        return all;
    if (t.starts_s.size() > most_starts) {
        all.note = fmt::format("starts of more than {} strokes are not marked", most_starts);
        return all;
    }
    numbers_at numbers;
    for (std::size_t i = 0; i < t.starts_s.size(); ++i)
        numbers[std::round(x(t.starts_s[i]) * 10.0) / 10.0].push_back(i + 1);
    std::string word = "stroke "; // for the first
    std::array<double, most_lines> free{};
    std::size_t lines = 1;
    std::size_t left_out = 0;
    for (auto i = numbers.begin(); i != numbers.end(); ++i) {
        const double from = i->first + aside;
        const double next = std::next(i) != numbers.end() ? std::next(i)->first : x.page_to;
        std::string label = fmt::format("{}", fmt::join(i->second, ", "));
        if (from + text_width(label, small_text) > x.page_to)
            label = join_runs(i->second);
        if (from + text_width(word + label, small_text) < next)
            label = word + label;
        word.clear();
        const auto line = static_cast<std::size_t>(
            std::find_if(free.begin(), free.end(), [&](double f) { return f <= i->first; }) - free.begin());
        if (line == free.size()) {
            left_out += i->second.size();
            all.marks.push_back({i->first, {}, 0});
            continue;
        }
        free[line] = from + text_width(label, small_text);
        lines = std::max(lines, line + 1);
        all.marks.push_back({i->first, std::move(label), line});
    }
    all.height = line_height * static_cast<double>(lines);
    if (left_out != 0)
        all.note = "no space for the start's number of " + counted(left_out, "stroke");
    return all;
}

void draw_stroke_starts(canvas& c, const stroke_starts& s, double top, double bottom)
{
    for (const stroke_starts::start& m : s.marks)
        c.line({m.at, top - 8.0 - line_height * static_cast<double>(m.line)}, {m.at, bottom},
               {.stroke = dark_grey, .width = 0.5, .dash = 2.0}, {.kind = "stroke-start"});
}

void number_stroke_starts(canvas& c, const stroke_starts& s, double top)
{
    if (s.marks.empty())
        return;
    const group g(c, {.id = "stroke-starts"});
    for (const stroke_starts::start& m : s.marks)
        if (!m.label.empty())
            c.text({m.at + aside, top - 3.0 - line_height * static_cast<double>(m.line)}, m.label,
                   {.size = small_text, .ink = dark_grey, .halo = true});
}

double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours)
{
    if (s.strokes.size() < 2)
        return 0.0;
    const group g(c, {.id = "strokes"});
    const double lead = colours ? swatch + gap : 0.0;
    double widest = 0.0;
    const std::vector<entry> entries = find_entries(s, t);
    const std::vector<std::string> names =
        shortened(write_entries(entries), most_of_width * where.width - lead - column_gap);
    for (const std::string& n : names)
        widest = std::max(widest, text_width(n, small_text));
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
    for (const std::string& line : wrap(notes, "; ", small_text, where.width, 2)) {
        c.text({where.x, where.y + height + cap_height(small_text) + 1.0}, line,
               {.size = small_text, .ink = dark_grey}, {.kind = "note"});
        height += row_height;
    }
    return height + 2.0;
}

} // namespace tactor::plot
