// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "plot/draw/axes.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

constexpr double two_columns = 120.0 * pt_per_mm; // of panels, from this width on
constexpr double panel_height = 150.0;
constexpr double labels_height = 24.0; // names of the groups, and the legend
constexpr double between = 14.0;
constexpr double bars_share = 0.72; // of a group's width

// Colours of methods, in order. A few differ in lightness too; more get the colours of strokes.
constexpr std::array<colour, 4> fills{light_grey, blue, orange, dark_grey};

colour fill_colour(std::size_t i, std::size_t count)
{
    if (count == 1)
        return blue;
    return count <= fills.size() ? fills[i] : stroke_colour(i);
}

void draw_error(canvas& c, const bar& b, const scale& y, double x, double cap)
{
    const double top = y(b.height + *b.error);
    const double low = y(b.height - *b.error);
    const style s{.stroke = ink, .width = 0.7};
    c.line({x, low}, {x, top}, s, {.kind = "error"});
    c.line({x - cap, top}, {x + cap, top}, s);
    c.line({x - cap, low}, {x + cap, low}, s);
}

// Draws values side by side in their order, so that equal ones are seen.
void draw_values(canvas& c, const bar& b, const scale& y, double x, double width)
{
    const double step = 0.7 * width / static_cast<double>(b.values.size());
    for (std::size_t i = 0; i < b.values.size(); ++i)
        c.circle({x + 0.15 * width + step * (static_cast<double>(i) + 0.5), y(b.values[i])},
                 std::min(1.1, 0.45 * step + 0.3),
                 {.fill = with_alpha(white, 0.7), .stroke = ink, .width = 0.3}, {.kind = "value"});
}

// Calls `draw` for each bar of a panel, by group and series, with its place.
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
        const double top = y(std::clamp(height, p.y_from, p.y_to));
        c.rect({x, top, width, y(p.y_from) - top},
               {.fill = fill_colour(i, p.series.size()), .stroke = ink, .width = 0.5},
               {.kind = "bar",
                .title = fmt::format("{}: {}", clean(p.groups[g]), number(height)),
                .data = {{"group", clean(p.groups[g])}, {"series", clean(p.series[i].name)}}});
    });
}

// Draws values and error bars, on top of the text across.
void draw_spread(canvas& c, const bar_panel& p, const scale& y, box inside)
{
    for_each_bar(p, inside, [&](std::size_t g, std::size_t i, double x, double width) {
        const bar& b = p.series[i].bars[g];
        draw_values(c, b, y, x, width);
        if (b.error)
            draw_error(c, b, y, x + width / 2.0, std::min(3.0, width / 4.0));
    });
}

void draw_group_names(canvas& c, const bar_panel& p, box inside)
{
    const double width = inside.width / static_cast<double>(p.groups.size());
    for (std::size_t g = 0; g < p.groups.size(); ++g)
        c.text({inside.x + width * (static_cast<double>(g) + 0.5),
                inside.bottom() + 3.0 + cap_height(small_text)},
               shorten(clean(p.groups[g]), small_text, width - 2.0),
               {.size = small_text, .anchor = align::middle}, {.kind = "group"});
}

void write_across(canvas& c, const std::string& text, box inside)
{
    if (text.empty())
        return;
    const double size = 0.9 * inside.width / text_width(text, 1.0, true);
    c.text({inside.x + inside.width / 2.0, inside.y + inside.height / 2.0 + cap_height(size) / 2.0}, text,
           {.size = size, .bold = true, .anchor = align::middle, .ink = with_alpha(vermilion, 0.4)},
           {.kind = "across"});
}

void draw_legend(canvas& c, const bar_panel& p, double x, double y, double width)
{
    double at = x;
    for (std::size_t i = 0; i < p.series.size(); ++i) {
        if (p.series[i].name.empty())
            continue;
        const double space = width / static_cast<double>(p.series.size()) - 12.0;
        const std::string name = shorten(clean(p.series[i].name), small_text, space);
        c.rect({at, y - 5.0, 6.0, 5.0},
               {.fill = fill_colour(i, p.series.size()), .stroke = ink, .width = 0.4}, {.kind = "legend"});
        c.text({at + 8.0, y}, name, {.size = small_text}, {.kind = "legend"});
        at += 12.0 + text_width(name, small_text) + 6.0;
    }
}

void draw_bar_panel(canvas& c, const bar_panel& p, const std::string& across, box where)
{
    const box inside{where.x + 28.0, where.y + 14.0, where.width - 30.0, where.height - 14.0 - labels_height};
    const scale y{p.y_from, p.y_to, inside.bottom(), inside.y};
    const group one(c, {.kind = "bars",
                        .data = {{"title", clean(p.title)},
                                 {"y0", fmt::format("{:.9g}", y(0.0))},
                                 {"y-scale", fmt::format("{:.9g}", y.per_unit())}}});
    c.text({where.x, where.y + cap_height(title_text)},
           shorten(clean(p.title), title_text, where.width, true), {.size = title_text, .bold = true});
    draw_vertical_axis(c, y, nice_ticks(p.y_from, p.y_to, 11), inside,
                       shorten(clean(p.y_title), label_text, inside.height),
                       inside.x - 24.0 + cap_height(label_text));
    draw_group_names(c, p, inside);
    draw_bars(c, p, y, inside);
    if (p.level)
        c.line({inside.x, y(*p.level)}, {inside.right(), y(*p.level)},
               {.stroke = ink, .width = 0.6, .dash = 2.5}, {.kind = "level"});
    c.line({inside.x, inside.bottom()}, {inside.right(), inside.bottom()}, {.stroke = ink, .width = 0.6});
    write_across(c, across, inside);
    draw_spread(c, p, y, inside);
    draw_legend(c, p, inside.x, where.bottom() - 2.0, inside.width);
}

} // namespace

canvas draw_bar_figure(const bar_figure& f)
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
    for (std::size_t i = 0; i < f.panels.size(); ++i) {
        const double x = margin + (width + between) * static_cast<double>(i % columns);
        draw_bar_panel(c, f.panels[i], across, {x, y, width, panel_height});
        if ((i + 1) % columns == 0 || i + 1 == f.panels.size())
            y += panel_height + 8.0;
    }
    y += draw_words(c, f.note, {margin, y, c.width - 2.0 * margin, 0.0}, 3, "note");
    c.height = y + margin;
    return c;
}

} // namespace tactor::plot
