// SPDX-License-Identifier: MIT
#include "plot/bar_figure.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double figure_width = 170.0 * pt_per_mm;
constexpr double panel_height = 150.0;
constexpr double labels_height = 24.0; // names of the groups, and the legend
constexpr double between = 14.0;

// Of methods, in order: a few differ in lightness too; more of them are told apart as strokes are.
constexpr std::array<colour, 4> fills{light_grey, blue, orange, dark_grey};

colour fill_of(std::size_t i, std::size_t of)
{
    if (of == 1)
        return blue;
    return of <= fills.size() ? fills[i] : of_stroke(i);
}

void draw_error(canvas& c, const bar& b, const scale& y, double x, double cap)
{
    const double top = y(*b.height + *b.error);
    const double low = y(*b.height - *b.error);
    const style s{.stroke = ink, .width = 0.7};
    c.line({x, low}, {x, top}, s, {.kind = "error"});
    c.line({x - cap, top}, {x + cap, top}, s);
    c.line({x - cap, low}, {x + cap, low}, s);
}

void draw_group(canvas& c, const bar_panel& p, std::size_t g, const scale& y, double left, double width)
{
    const double space = 0.72 * width;
    const double each = space / static_cast<double>(p.series.size());
    for (std::size_t i = 0; i < p.series.size(); ++i) {
        const bar& b = p.series[i].bars[g];
        if (!b.height)
            continue;
        const double x = left + (width - space) / 2.0 + each * static_cast<double>(i);
        const double top = y(std::clamp(*b.height, p.y_from, p.y_to));
        c.rect({x, top, each, y(p.y_from) - top},
               {.fill = fill_of(i, p.series.size()), .stroke = ink, .width = 0.5},
               {.kind = "bar",
                .title = fmt::format("{}: {}", clean(p.groups[g]), number(*b.height)),
                .data = {{"group", clean(p.groups[g])}, {"series", clean(p.series[i].name)}}});
        if (b.error)
            draw_error(c, b, y, x + each / 2.0, std::min(3.0, each / 4.0));
    }
    c.text({left + width / 2.0, y(p.y_from) + 3.0 + cap_height(small_text)},
           shorten(clean(p.groups[g]), small_text, width - 2.0),
           {.size = small_text, .anchor = align::middle}, {.kind = "group"});
}

void draw_legend(canvas& c, const bar_panel& p, double x, double y, double width)
{
    double at = x;
    for (std::size_t i = 0; i < p.series.size(); ++i) {
        if (p.series[i].name.empty())
            continue;
        const double space = width / static_cast<double>(p.series.size()) - 12.0;
        const std::string name = shorten(clean(p.series[i].name), small_text, space);
        c.rect({at, y - 5.0, 6.0, 5.0}, {.fill = fill_of(i, p.series.size()), .stroke = ink, .width = 0.4},
               {.kind = "legend"});
        c.text({at + 8.0, y}, name, {.size = small_text}, {.kind = "legend"});
        at += 12.0 + text_width(name, small_text) + 6.0;
    }
}

void draw_panel_of(canvas& c, const bar_panel& p, const std::string& across, box where)
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
    const double width = inside.width / static_cast<double>(p.groups.size());
    for (std::size_t g = 0; g < p.groups.size(); ++g)
        draw_group(c, p, g, y, inside.x + width * static_cast<double>(g), width);
    if (p.level)
        c.line({inside.x, y(*p.level)}, {inside.right(), y(*p.level)},
               {.stroke = ink, .width = 0.6, .dash = 2.5}, {.kind = "level"});
    c.line({inside.x, inside.bottom()}, {inside.right(), inside.bottom()}, {.stroke = ink, .width = 0.6});
    draw_legend(c, p, inside.x, where.bottom() - 2.0, inside.width);
    if (across.empty())
        return;
    const double size = 0.9 * inside.width / text_width(across, 1.0, true);
    c.text({inside.x + inside.width / 2.0, inside.y + inside.height / 2.0 + cap_height(size) / 2.0}, across,
           {.size = size, .bold = true, .anchor = align::middle, .ink = with_alpha(vermilion, 0.6)},
           {.kind = "across"});
}

} // namespace

canvas draw_bars_of(const bar_figure& f)
{
    canvas c;
    c.width = figure_width;
    c.title = clean(f.title);
    c.description = f.note;
    double y = margin + cap_height(title_size);
    const std::string across = clean(f.across);
    c.text({margin, y},
           shorten(clean(f.title) + (across.empty() ? "" : " (" + across + ")"), title_size,
                   c.width - 2.0 * margin, true),
           {.size = title_size, .bold = true});
    y += 8.0;
    const double width = (c.width - 2.0 * margin - between) / 2.0;
    for (std::size_t i = 0; i < f.panels.size(); ++i) {
        const double x = margin + (i % 2 == 0 ? 0.0 : width + between);
        draw_panel_of(c, f.panels[i], across, {x, y, width, panel_height});
        if (i % 2 == 1 || i + 1 == f.panels.size())
            y += panel_height + 8.0;
    }
    c.text({margin, y + cap_height(small_text)}, f.note, {.size = small_text, .ink = dark_grey},
           {.kind = "note"});
    c.height = y + line_pitch + margin;
    return c;
}

} // namespace tactor::plot
