// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "plot/draw/array_frame.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

constexpr double two_columns = 120.0 * pt_per_mm; // least width for two columns of panels
constexpr double panel_height = 150.0;
constexpr double labels_height = 24.0; // space for the names of groups and one row of the legend
constexpr double between = 14.0;
constexpr double largest_dot = 2.3; // radius of the largest dot
constexpr double bars_share = 0.72; // fraction of a group's width that its bars take

constexpr double names_length = 40.0;       // usual length of vertical names
constexpr double most_names_length = 100.0; // length of vertical names that differ only late
constexpr double left_space = 28.0;         // usual space at the left of a diagram
constexpr double right_space = 2.0;         // space at the right of a diagram

// Colours of methods, in order. They also differ in lightness. If there are more methods, the colours of
// strokes are used.
constexpr std::array<colour, 4> fills{light_grey, blue, orange, dark_grey};

colour fill_colour(std::size_t i, std::size_t count)
{
    if (count == 1)
        return blue;
    return count <= fills.size() ? fills[i] : stroke_colour(i);
}

void draw_error_bar(canvas& c, const bar& b, const scale& y, double x, double cap)
{
    const double top = y(b.error->second);
    const double low = y(b.error->first);
    const style s{.stroke = ink, .width = 0.7};
    c.line({x, low}, {x, top}, s, {.kind = "error"});
    c.line({x - cap, top}, {x + cap, top}, s);
    c.line({x - cap, low}, {x + cap, low}, s);
}

// Returns the horizontal distance between the values of a bar.
double value_step(const bar& b, double width)
{
    return 0.7 * width / static_cast<double>(b.values.size());
}

// Returns the places of a bar's values. They are side by side in their order, so that equal values do not
// cover each other.
std::vector<spot> place_values(const bar& b, const scale& y, double x, double width)
{
    std::vector<spot> places;
    for (const double v : b.values)
        places.push_back(
            {x + 0.15 * width + value_step(b, width) * (static_cast<double>(places.size()) + 0.5), y(v)});
    return places;
}

void draw_values(canvas& c, const bar& b, const scale& y, double x, double width)
{
    for (const spot& at : place_values(b, y, x, width))
        c.circle(at, std::min(1.1, 0.45 * value_step(b, width) + 0.3),
                 {.fill = with_alpha(white, 0.7), .stroke = ink, .width = 0.3}, {.kind = "value"});
}

// Calls `draw` with the place of each bar in a panel, by group and series.
template <class Draw>
void for_each_bar(const bar_panel& p, box inside, Draw&& draw)
{
    const double width = inside.width / static_cast<double>(p.groups.size());
    const double each = bars_share * width / static_cast<double>(p.series.size());
    for (std::size_t g = 0; g < p.groups.size(); ++g)
        for (std::size_t i = 0; i < p.series.size(); ++i) {
            const double left = inside.x + width * (static_cast<double>(g) + (1.0 - bars_share) / 2.0);
            draw(g, i, left + each * static_cast<double>(i), each);
        }
}

void draw_bars(canvas& c, const bar_panel& p, const scale& y, box inside)
{
    for_each_bar(p, inside, [&](std::size_t g, std::size_t i, double x, double width) {
        const double height = p.series[i].bars[g].height;
        const double end = y(std::clamp(height, p.y_from, p.y_to));
        const double foot = y(std::clamp(0.0, p.y_from, p.y_to));
        c.rect({x, std::min(end, foot), width, std::abs(foot - end)},
               {.fill = fill_colour(i, p.series.size()), .stroke = ink, .width = 0.5},
               {.kind = "bar",
                .title = fmt::format("{}: {}", clean(p.groups[g]), number(height)),
                .data = {{"group", clean(p.groups[g])}, {"series", clean(p.series[i].name)}}});
    });
}

void draw_value_lines(canvas& c, const bar_panel& p, const scale& y, box inside)
{
    // A set of lines for each series, and a set for each group in which lines join the values of all series.
    std::vector<std::vector<std::vector<spot>>> sets(p.series.size() + p.groups.size() - p.joined);
    for_each_bar(p, inside, [&](std::size_t g, std::size_t i, double x, double width) {
        const std::vector<spot> places = place_values(p.series[i].bars[g], y, x, width);
        std::vector<std::vector<spot>>& lines = sets[g < p.joined ? i : p.series.size() + g - p.joined];
        lines.resize(places.size());
        for (std::size_t k = 0; k < places.size(); ++k)
            lines[k].push_back(places[k]);
    });
    for (const std::vector<std::vector<spot>>& lines : sets)
        for (const std::vector<spot>& line : lines)
            if (line.size() > 1)
                c.poly(line, false, {.stroke = with_alpha(ink, 0.35), .width = 0.3}, {.kind = "value-line"});
}

// Draws values, the lines between them, and error bars. They are above the text across the panel.
void draw_spread(canvas& c, const bar_panel& p, const scale& y, box inside)
{
    draw_value_lines(c, p, y, inside);
    for_each_bar(p, inside, [&](std::size_t g, std::size_t i, double x, double width) {
        const bar& b = p.series[i].bars[g];
        draw_values(c, b, y, x, width);
        if (b.error)
            draw_error_bar(c, b, y, x + width / 2.0, std::min(3.0, width / 4.0));
    });
}

double find_widest(const std::vector<std::string>& texts)
{
    double widest = 0.0;
    for (const std::string& t : texts)
        widest = std::max(widest, text_width(t, small_text));
    return widest;
}

// Returns the space for labels and title of a vertical axis. It is usually left_space, so that diagrams below
// each other have the same left edge.
double find_left_space(const ticks& t)
{
    std::vector<std::string> labels;
    for (const double v : t.at)
        labels.push_back(t.label(v));
    return std::max(left_space, cap_height(label_text) + 7.0 + find_widest(labels));
}

// Draws a vertical axis whose title is at the left edge of the panel `where`.
void draw_left_axis(canvas& c, const scale& y, const ticks& t, box inside, const std::string& title,
                    box where)
{
    draw_vertical_axis(c, y, t, inside, shorten_title(title, label_text, inside.height),
                       where.x + cap_height(label_text));
}

void draw_text_across(canvas& c, const std::string& text, box inside)
{
    if (text.empty())
        return;
    const double size = 0.9 * inside.width / text_width(text, 1.0, true);
    c.text({inside.x + inside.width / 2.0, inside.y + inside.height / 2.0 + cap_height(size) / 2.0}, text,
           {.size = size, .bold = true, .anchor = align::middle, .ink = with_alpha(vermilion, 0.4)},
           {.kind = "across"});
}

// Draws the names of the series, in rows of at most `width`. The first row ends at y. Returns the height of
// the other rows. If `c` is null, only computes this height.
double draw_legend(canvas* c, const bar_panel& p, double x, double y, double width)
{
    constexpr double row_height = 9.0;
    double at = x;
    double row = y;
    for (std::size_t i = 0; i < p.series.size(); ++i) {
        if (p.series[i].name.empty())
            continue;
        const std::string name = shorten(clean(p.series[i].name), small_text, width - 8.0);
        const double need = 8.0 + text_width(name, small_text);
        if (at > x && at + need > x + width) {
            at = x;
            row += row_height;
        }
        if (c != nullptr) {
            c->rect({at, row - 5.0, 6.0, 5.0},
                    {.fill = fill_colour(i, p.series.size()), .stroke = ink, .width = 0.4},
                    {.kind = "legend"});
            c->text({at + 8.0, row}, name, {.size = small_text}, {.kind = "legend"});
        }
        at += need + 10.0;
    }
    return row - y;
}

// Text and measures of a panel of bars with a certain width.
struct bar_layout {
    ticks at = {};
    box inside = {}; // area of the bars, relative to the panel; without height
    std::vector<std::string> names = {};
    bool upwards = false; // true if names are vertical because one is wider than its group
    double names_height = 0.0;
    double legend = 0.0; // height of the rows of the legend after the first
};

bar_layout lay_out(const bar_panel& p, double width)
{
    bar_layout l{.at = nice_ticks(p.y_from, p.y_to, 11)};
    l.inside = {find_left_space(l.at), 14.0, width - find_left_space(l.at) - right_space, 0.0};
    std::ranges::transform(p.groups, std::back_inserter(l.names), clean);
    l.upwards = find_widest(l.names) > l.inside.width / static_cast<double>(p.groups.size()) - 2.0;
    if (l.upwards)
        l.names = shorten_names(p.groups, small_text, names_length, most_names_length);
    l.names_height = l.upwards ? find_widest(l.names) : cap_height(small_text);
    l.legend = draw_legend(nullptr, p, 0.0, 0.0, l.inside.width);
    return l;
}

void draw_group_names(canvas& c, const bar_layout& l, box inside)
{
    const double width = inside.width / static_cast<double>(l.names.size());
    const double cap = cap_height(small_text);
    for (std::size_t g = 0; g < l.names.size(); ++g)
        c.text({inside.x + width * (static_cast<double>(g) + 0.5) + (l.upwards ? cap / 2.0 : 0.0),
                inside.bottom() + 3.0 + (l.upwards ? 0.0 : cap)},
               l.names[g],
               {.size = small_text, .anchor = l.upwards ? align::end : align::middle, .upwards = l.upwards},
               {.kind = "group"});
}

void draw_panel_title(canvas& c, const std::string& title, box where)
{
    c.text({where.x, where.y + cap_height(title_text)}, shorten_title(title, title_text, where.width, true),
           {.size = title_text, .bold = true}, {.kind = "panel-title"});
}

void draw_bar_panel(canvas& c, const bar_panel& p, const std::string& across, box where)
{
    const bar_layout l = lay_out(p, where.width);
    const box inside{where.x + l.inside.x, where.y + l.inside.y, l.inside.width,
                     where.height - l.inside.y - labels_height - l.names_height + cap_height(small_text) -
                         l.legend};
    const scale y{p.y_from, p.y_to, inside.bottom(), inside.y};
    const group one(c, {.kind = "bars",
                        .data = {{"title", clean(p.title)},
                                 {"y0", fmt::format("{:.9g}", y(0.0))},
                                 {"y-scale", fmt::format("{:.9g}", y.points_per_unit())}}});
    draw_panel_title(c, p.title, where);
    draw_left_axis(c, y, l.at, inside, p.y_title, where);
    draw_group_names(c, l, inside);
    draw_bars(c, p, y, inside);
    if (p.level)
        c.line({inside.x, y(*p.level)}, {inside.right(), y(*p.level)},
               {.stroke = ink, .width = 0.6, .dash = 2.5}, {.kind = "level"});
    c.line({inside.x, inside.bottom()}, {inside.right(), inside.bottom()}, {.stroke = ink, .width = 0.6});
    draw_text_across(c, across, inside);
    draw_spread(c, p, y, inside);
    draw_legend(&c, p, inside.x, where.bottom() - 2.0 - l.legend, inside.width);
}

void draw_dots(canvas& c, const curve_panel& p, const scale& x, const scale& y)
{
    constexpr double least = 0.5;
    double heaviest = 0.0;
    for (const curve& one : p.curves)
        for (const weighted_dot& d : one.dots)
            heaviest = std::max(heaviest, d.weight);
    for (const curve& one : p.curves)
        for (const weighted_dot& d : one.dots)
            c.circle({x(d.at.x), y(d.at.y)}, std::max(least, largest_dot * std::sqrt(d.weight / heaviest)),
                     {.fill = with_alpha(stroke_colour(one.colour), 0.3),
                      .stroke = with_alpha(ink, 0.6),
                      .width = 0.3},
                     {.kind = "dot", .data = {{"weight", number(d.weight)}}});
}

void draw_curves(canvas& c, const curve_panel& p, const scale& x, const scale& y, box inside)
{
    for (const curve& one : p.curves) {
        std::vector<spot> on_page;
        for (const spot& v : one.line)
            on_page.push_back({x(v.x), y(v.y)});
        const style look{.stroke = with_alpha(stroke_colour(one.colour), one.thick ? 1.0 : 0.5),
                         .width = one.thick ? 1.6 : 0.5};
        for (const std::vector<spot>& part : clip(on_page, inside))
            c.poly(simplify(part, 0.05), false, look, {.kind = one.thick ? "mean-curve" : "curve"});
    }
}

// Writes the names of dots next to the dots and inside the panel, or above a dot if there is no space next to
// it.
void draw_dot_names(canvas& c, const curve_panel& p, const scale& x, const scale& y, box inside)
{
    std::vector<spot> sites;
    std::vector<std::string> names;
    for (const curve& one : p.curves)
        for (const weighted_dot& d : one.dots)
            if (!d.name.empty()) {
                sites.push_back({x(d.at.x), y(d.at.y)});
                names.push_back(shorten(clean(d.name), small_text, inside.width / 2.0));
            }
    label_placer taken(inside);
    for (const spot& site : sites)
        taken.block_disc(site, largest_dot);
    for (std::size_t i = 0; i < sites.size(); ++i) {
        constexpr double reach = 20.0;
        const spot above{sites[i].x, sites[i].y - largest_dot - 1.5};
        c.text(taken.place(names[i], small_text, sites, i, largest_dot + 1.5, reach).value_or(above),
               names[i], {.size = small_text}, {.kind = "name"});
    }
}

// Makes the axes of a panel. For a panel to scale, extends one of the ranges at both ends.
std::pair<scale, scale> make_scales(const curve_panel& p, box inside)
{
    if (!p.to_scale)
        return {{p.x.from, p.x.to, inside.x, inside.right()}, {p.y.from, p.y.to, inside.bottom(), inside.y}};
    const double per_pt = std::max((p.x.to - p.x.from) / inside.width, (p.y.to - p.y.from) / inside.height);
    const double x = 0.5 * (p.x.from + p.x.to);
    const double y = 0.5 * (p.y.from + p.y.to);
    const double half_width = 0.5 * per_pt * inside.width;
    const double half_height = 0.5 * per_pt * inside.height;
    return {{x - half_width, x + half_width, inside.x, inside.right()},
            {y - half_height, y + half_height, inside.y, inside.bottom()}};
}

ticks find_ticks(const scale& y, bool logs)
{
    constexpr std::size_t most = 7;
    return logs ? log_ticks(y.from, y.to, most) : nice_ticks(y.from, y.to, most);
}

// Draws the names of the curves, in rows of at most `width`. Returns the height of the rows. If `c` is null,
// only computes this height.
double draw_curve_names(canvas* c, const curve_panel& p, double x, double y, double width)
{
    std::vector<series> named;
    for (const curve& one : p.curves)
        if (!one.name.empty())
            named.push_back({clean(one.name), {}, {.stroke = stroke_colour(one.colour), .width = 1.6}});
    return draw_line_legend(c, named, x, y, width);
}

// Draws a panel of curves. `names_height` is the space for the names of the curves; it is the same in all
// panels so that all have the same scale.
void draw_curve_panel(canvas& c, const curve_panel& p, const std::string& across, double names_height,
                      box where)
{
    const double top = 14.0 + names_height;
    box inside{where.x + left_space, where.y + top, where.width - left_space - right_space,
               where.height - top - axis_height - 2.0};
    const double more = find_left_space(find_ticks(make_scales(p, inside).second, p.y.logs)) - left_space;
    inside.x += more;
    inside.width -= more;
    const auto [x, y] = make_scales(p, inside);
    const group one(c, {.kind = "curves",
                        .data = {{"title", clean(p.title)},
                                 {"x0", fmt::format("{:.9g}", x(0.0))},
                                 {"x-scale", fmt::format("{:.9g}", x.points_per_unit())},
                                 {"y0", fmt::format("{:.9g}", y(0.0))},
                                 {"y-scale", fmt::format("{:.9g}", y.points_per_unit())}}});
    const double key = text_width(p.key, small_text);
    c.text({where.right(), where.y + cap_height(title_text)}, p.key,
           {.size = small_text, .anchor = align::end, .ink = dark_grey}, {.kind = "key"});
    draw_panel_title(c, p.title, {where.x, where.y, where.width - key - 6.0, where.height});
    draw_curve_names(&c, p, where.x + left_space, where.y + 11.0, where.width - left_space - right_space);
    draw_left_axis(c, y, find_ticks(y, p.y.logs), inside, p.y.title, where);
    draw_horizontal_axis(c, x, inside.bottom(), inside.y, shorten_title(p.x.title, label_text, inside.width),
                         p.x.logs);
    const style guide{.stroke = ink, .width = 0.6, .dash = 2.5};
    if (p.y.level)
        c.line({inside.x, y(*p.y.level)}, {inside.right(), y(*p.y.level)}, guide, {.kind = "level"});
    if (p.x.level)
        c.line({x(*p.x.level), inside.y}, {x(*p.x.level), inside.bottom()}, guide, {.kind = "level"});
    draw_text_across(c, across, inside);
    draw_dots(c, p, x, y);
    draw_curves(c, p, x, y, inside);
    draw_dot_names(c, p, x, y, inside);
}

// Returns a colour between white, for share 0, and blue, for share 1.
colour tint(double share)
{
    const auto mix = [share](std::uint8_t full) {
        return static_cast<std::uint8_t>(std::lround(255.0 - share * (255.0 - full)));
    };
    return {mix(blue.r), mix(blue.g), mix(blue.b)};
}

// Calls `draw` with the row, the column, the box and the share of each cell. The share is that of the cell's
// count in its row.
template <class Draw>
void for_each_cell(const matrix_panel& p, box inside, Draw&& draw)
{
    const double width = inside.width / static_cast<double>(p.names.size());
    const double height = inside.height / static_cast<double>(p.names.size());
    for (std::size_t row = 0; row < p.names.size(); ++row) {
        const std::vector<std::size_t>& counts = p.counts[row];
        const auto all = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
        for (std::size_t k = 0; k < counts.size(); ++k)
            draw(row, k,
                 box{inside.x + width * static_cast<double>(k), inside.y + height * static_cast<double>(row),
                     width, height},
                 counts[k] == 0 ? 0.0 : static_cast<double>(counts[k]) / all);
    }
}

void draw_cells(canvas& c, const matrix_panel& p, box inside)
{
    for_each_cell(p, inside, [&](std::size_t row, std::size_t k, box where, double share) {
        const std::string count = fmt::format("{}", p.counts[row][k]);
        c.rect(where, {.fill = tint(share), .stroke = light_grey, .width = 0.4},
               {.kind = "cell",
                .title = fmt::format("{}: {}: {}", clean(p.names[row]), clean(p.names[k]), count),
                .data = {{"row", clean(p.names[row])}, {"column", clean(p.names[k])}, {"count", count}}});
    });
}

// Writes the counts that are not 0.
void draw_counts(canvas& c, const matrix_panel& p, box inside)
{
    constexpr double light_from = 0.85; // share above which white text has more contrast than black text
    for_each_cell(p, inside, [&](std::size_t row, std::size_t k, box where, double share) {
        const double size = std::min(small_text, 0.8 * where.height);
        if (share > 0.0)
            c.text({where.x + where.width / 2.0, where.y + where.height / 2.0 + cap_height(size) / 2.0},
                   fmt::format("{}", p.counts[row][k]),
                   {.size = size, .anchor = align::middle, .ink = share > light_from ? white : ink},
                   {.kind = "count"});
    });
}

// Shortens the names of rows and columns for a panel of a certain width.
std::vector<std::string> shorten_cell_names(const matrix_panel& p, double width)
{
    return shorten_names(p.names, small_text, names_length, std::min(most_names_length, width / 3.0));
}

// Draws a matrix. The names of the rows are on the left, and the names of the columns are below, written
// vertically.
void draw_matrix_panel(canvas& c, const matrix_panel& p, const std::string& across, box where)
{
    const std::vector<std::string> names = shorten_cell_names(p, where.width);
    const double names_space = std::max(names_length, find_widest(names)) + 14.0; // includes the title
    const box inside{where.x + names_space, where.y + 14.0, where.width - names_space - right_space,
                     where.height - 14.0 - names_space};
    const group one(c, {.kind = "matrix", .data = {{"title", clean(p.title)}}});
    draw_panel_title(c, p.title, where);
    draw_cells(c, p, inside);
    draw_text_across(c, across, inside);
    draw_counts(c, p, inside);
    const double half = cap_height(small_text) / 2.0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const double middle = (static_cast<double>(i) + 0.5) / static_cast<double>(names.size());
        c.text({inside.x - 3.0, inside.y + inside.height * middle + half}, names[i],
               {.size = small_text, .anchor = align::end}, {.kind = "row"});
        c.text({inside.x + inside.width * middle + half, inside.bottom() + 3.0}, names[i],
               {.size = small_text, .anchor = align::end, .upwards = true}, {.kind = "column"});
    }
    c.text({where.x + cap_height(label_text), inside.y + inside.height / 2.0}, p.row_title,
           {.size = label_text, .anchor = align::middle, .upwards = true}, {.kind = "axis-title"});
    c.text({inside.x + inside.width / 2.0, where.bottom() - 2.0}, p.column_title,
           {.size = label_text, .anchor = align::middle}, {.kind = "axis-title"});
}

} // namespace

canvas draw_panels(const panel_figure& f)
{
    canvas c = make_canvas(f.width_mm);
    c.title = clean(f.title);
    c.description = f.note;
    double y = margin;
    const std::string across = clean(f.across);
    if (f.heading)
        y += draw_heading(c, clean(f.title) + (across.empty() ? "" : " (" + across + ")"), {},
                          {margin, y, c.width - 2.0 * margin, 0.0}) +
             8.0;
    const std::size_t columns = c.width >= two_columns ? 2 : 1;
    const double width =
        (c.width - 2.0 * margin - between * static_cast<double>(columns - 1)) / static_cast<double>(columns);
    double height = panel_height; // greater for a legend with several rows, and for long names
    for (const bar_panel& p : f.bars) {
        const bar_layout l = lay_out(p, width);
        height = std::max(height, panel_height + l.legend + std::max(0.0, l.names_height - names_length));
    }
    for (const matrix_panel& p : f.matrices)
        height = std::max(height, panel_height + find_widest(shorten_cell_names(p, width)) - names_length);
    double names_height = 0.0;
    for (const curve_panel& p : f.curves)
        names_height =
            std::max(names_height, draw_curve_names(nullptr, p, 0.0, 0.0, width - left_space - right_space));
    std::size_t count = 0;
    const auto draw_each = [&](const auto& panels, const auto& draw) {
        for (const auto& p : panels) {
            if (count % columns == 0 && count > 0)
                y += height + 8.0;
            draw(c, p, across,
                 {margin + (width + between) * static_cast<double>(count % columns), y, width, height});
            ++count;
        }
    };
    draw_each(f.bars, draw_bar_panel);
    draw_each(f.curves, [&](canvas& on, const curve_panel& p, const std::string& text, box where) {
        draw_curve_panel(on, p, text, names_height, where);
    });
    draw_each(f.matrices, draw_matrix_panel);
    y += count > 0 ? height + 8.0 : 0.0;
    y += draw_wrapped_text(c, f.note, {margin, y, c.width - 2.0 * margin, 0.0}, 6, "note");
    c.height = y + margin;
    return c;
}

} // namespace tactor::plot
