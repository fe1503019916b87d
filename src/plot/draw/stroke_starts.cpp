// SPDX-License-Identifier: MIT
#include "plot/draw/stroke_starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_starts = 60; // more say nothing
constexpr std::size_t most_lines = 3;   // of numbers
constexpr double line_height = 7.0;
constexpr double aside = 2.0; // of a number, behind its start

using numbers_at = std::map<double, std::vector<std::size_t>>; // by x

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

stroke_starts look_at_starts(const timeline& t, const scale& x)
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

} // namespace tactor::plot
