// SPDX-License-Identifier: MIT
#include "plot/draw/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
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

constexpr std::size_t most_instants = 24; // most instants of `continuous` that are drawn as positions
constexpr std::size_t looked_at = 4000;   // instants of `continuous` that are searched for playing tactors

// Returns the name of a repeated stroke without " (2 of 3)", which files add to the names of repeats. Returns
// "" for other strokes.
std::string find_repeated_name(const std::string& name)
{
    constexpr std::string_view digits = "0123456789";
    const std::size_t open = name.rfind(" (");
    const std::size_t number = open == std::string::npos ? open : name.find_first_not_of(digits, open + 2);
    if (number == std::string::npos || number == open + 2 || name.compare(number, 4, " of ") != 0)
        return {};
    const std::size_t end = name.find_first_not_of(digits, number + 4);
    return end + 1 == name.size() && name[end] == ')' && end > number + 4 ? name.substr(0, open) : "";
}

class maker {
public:
    explicit maker(const scene& s) : scene_(s), plays_(s.tactors.tactors.size(), false) {}

    timeline make()
    {
        place();
        find_looks();
        for (std::size_t i = 0; i < scene_.plans.size(); ++i) {
            const plan& p = scene_.plans[i].plan;
            if (p.curve)
                add_instants(i, p);
            else
                add_bursts(i, p);
        }
        for (unsigned i = 0; i < plays_.size(); ++i)
            if (plays_[i])
                t_.playing.push_back(i);
        return std::move(t_);
    }

private:
    void place()
    {
        t_.starts_s = start_times_s(scene_.plans);
        for (std::size_t i = 0; i < scene_.plans.size(); ++i) {
            const plan& p = scene_.plans[i].plan;
            t_.ends_s.push_back(t_.starts_s[i] + p.total_s);
            t_.total_s = std::max(t_.total_s, t_.ends_s.back());
            t_.sampled = t_.sampled || p.curve.has_value();
        }
        t_.sample_s = nice_ticks(0.0, std::max(t_.total_s, 1e-6), most_instants + 1).step;
    }

    void find_looks()
    {
        std::map<std::string, std::size_t> repeated;
        std::size_t next = 0;
        for (const stroke& s : scene_.strokes) {
            const std::string name = find_repeated_name(s.name);
            const auto known = name.empty() ? repeated.end() : repeated.find(name);
            t_.looks.push_back(known == repeated.end() ? next++ : known->second);
            if (!name.empty())
                repeated.emplace(name, t_.looks.back());
        }
    }

    void note(const burst& b)
    {
        for (const drive& d : b.drives) {
            plays_[d.tactor] = true;
            t_.peak = std::max(t_.peak, d.amplitude);
        }
    }

    void add_bursts(std::size_t stroke, const plan& p)
    {
        const double start = t_.starts_s[stroke];
        for (const burst& b : p.bursts) {
            note(b);
            t_.bursts.push_back({t_.bursts.size(), stroke, start + b.onset_s,
                                 start + b.onset_s + b.duration_s, start + b.tau_s.value_or(b.onset_s), &b});
        }
    }

    void add_instants(std::size_t stroke, const plan& p)
    {
        const double start = t_.starts_s[stroke];
        for (double k = 0.0; k * t_.sample_s <= p.stroke_duration_s + 1e-9; k += 1.0) {
            const double at = std::min(k * t_.sample_s, p.stroke_duration_s);
            burst& b = t_.instants.emplace_back();
            p.curve->at(at, b);
            t_.bursts.push_back({t_.bursts.size(), stroke, start + at, start + at, start + at, &b});
        }
        burst b;
        const auto n = static_cast<std::size_t>(
            std::clamp(p.stroke_duration_s / continuous_step_s, 1.0, static_cast<double>(looked_at)));
        for (std::size_t i = 0; i <= n; ++i) {
            p.curve->at(p.stroke_duration_s * static_cast<double>(i) / static_cast<double>(n), b);
            note(b);
        }
    }

    const scene& scene_;
    timeline t_;
    std::vector<bool> plays_;
};

constexpr double lowest_level = 2.2;
constexpr double most_height = 460.0; // greatest height of rows if each row gets a label, pt
constexpr double most_unlabelled = 260.0;
constexpr double label_pitch = 5.6; // least distance between labels, pt
constexpr double least_space = 60.0;

std::string make_label(const array& a, const std::vector<unsigned>& tactors, bool channels)
{
    if (tactors.size() > 1)
        return fmt::format("{}-{}", tactors.front(), tactors.back());
    return channels ? fmt::format("{} ({})", tactors.front(), a.tactors[tactors.front()].channel)
                    : fmt::format("{}", tactors.front());
}

constexpr std::size_t most_starts = 60; // more starts would not be legible
constexpr double aside = 2.0;           // distance between a number and the line of its start

constexpr double row_height = 8.5;
constexpr double swatch = 8.0;
constexpr double gap = 3.0;           // gap between a swatch and a name
constexpr double column_gap = 10.0;   // least gap between two columns
constexpr double most_of_width = 0.5; // greatest width of an entry, as a fraction, if there are several
constexpr std::size_t most_rows = 12;

// An entry of the legend. It is for one stroke or for all repeats of a stroke.
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

// Returns ascending numbers as text. Consecutive numbers are joined: "1-4, 6".
std::string format_number_ranges(const std::vector<std::size_t>& numbers)
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

timeline make_timeline(const scene& s)
{
    return maker(s).make();
}

colour burst_colour(const timeline& t, const shown_burst& b) noexcept
{
    return t.has_several_strokes() ? stroke_colour(t.looks[b.stroke])
                                   : map_to_colour(t.total_s > 0.0 ? b.target_s / t.total_s : 0.0);
}

void draw_time_strip(canvas& c, box where)
{
    constexpr int steps = 128;
    const group g(c, {.id = "time-colours", .title = "colour of each time"});
    // Each rectangle reaches to the end of the strip, so that there are no visible gaps between rectangles.
    for (int i = 0; i < steps; ++i) {
        const double part = static_cast<double>(i) / steps;
        c.rect({where.x + part * where.width, where.y, (1.0 - part) * where.width, where.height},
               {.fill = map_to_colour((i + 0.5) / steps)});
    }
    c.rect(where, {.stroke = ink, .width = 0.4});
    const spot start{where.x, where.y + where.height / 2.0};
    if (c.loop_s > loop_pause_s)
        c.moving_circle(start, 0.6 * where.height, {.fill = white, .stroke = ink, .width = 0.9},
                        {0.0, 1.0 - loop_pause_s / c.loop_s, {start, {where.right(), start.y}}},
                        {.kind = "now"});
}

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
    const bool channels = !has_matching_channels(a);
    l.heading = channels ? "tactor (ch)" : "tactor";
    for (lane& r : l.rows) {
        r.label = make_label(a, r.tactors, channels);
        l.label_width = std::max(l.label_width, text_width(r.label, small_text));
    }
    l.label_width = std::max(l.label_width, text_width(l.heading, small_text));
    return l;
}

bool lanes::fit(double space, double highest)
{
    const auto all = static_cast<double>(std::max<std::size_t>(1, rows.size() * levels));
    height = std::clamp(std::min(space, most_height) / all, lowest_level, highest);
    return total_height() <= space + 1e-9;
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
        if (lower.size() > 2) // a shorter outline is the line of 0
            shape.insert(shape.end(), lower.rbegin(), lower.rend());
    }
    return shapes;
}

double starts_height(const timeline& t)
{
    return t.has_several_strokes() ? 7.0 : 0.0;
}

std::string draw_stroke_starts(canvas& c, const timeline& t, const scale& x, double top, double bottom)
{
    if (!t.has_several_strokes())
        return {};
    if (t.starts_s.size() > most_starts)
        return fmt::format("starts of more than {} strokes are not marked", most_starts);
    const group g(c, {.id = "stroke-starts"});
    std::map<double, std::vector<std::size_t>> numbers; // numbers of strokes, by the x of their starts
    for (std::size_t i = 0; i < t.starts_s.size(); ++i)
        numbers[std::round(x(t.starts_s[i]) * 10.0) / 10.0].push_back(i + 1);
    std::string word = "stroke "; // written only before the first number
    double free = 0.0;
    std::size_t omitted = 0;
    for (auto i = numbers.begin(); i != numbers.end(); ++i) {
        const auto& [at, strokes] = *i;
        const double next = std::next(i) == numbers.end() ? x.page_to : std::next(i)->first;
        c.line({at, top - 8.0}, {at, bottom}, {.stroke = dark_grey, .width = 0.5, .dash = 2.0},
               {.kind = "stroke-start"});
        std::string label = format_number_ranges(strokes);
        if (at + aside + text_width(word + label, small_text) < next)
            label = word + label;
        word.clear();
        if (at < free || at + aside + text_width(label, small_text) > x.page_to) {
            omitted += strokes.size();
            continue;
        }
        free = at + aside + text_width(label, small_text);
        c.text({at + aside, top - 3.0}, label, {.size = small_text, .ink = dark_grey, .halo = true});
    }
    return omitted == 0 ? "" : "no space for the start's number of " + counted(omitted, "stroke");
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
        names.push_back(shorten(format_number_ranges(e.numbers) + (e.name.empty() ? "" : " " + e.name),
                                small_text, most_of_width * where.width - lead - column_gap));
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
