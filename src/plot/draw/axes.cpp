// SPDX-License-Identifier: MIT
#include "plot/draw/axes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plot/paint/text.hpp"

namespace tactor::plot {

namespace {

constexpr double tick_length = 2.5;

constexpr double head_length = 3.6;
constexpr double head_half = 1.3;
constexpr double tail = 4.0; // tail of an arrow that points from outside

// Draws a head with its tip at x; direction 1 points to the right.
void draw_head(canvas& c, double x, double y, double direction)
{
    c.poly(
        {{x, y}, {x - direction * head_length, y - head_half}, {x - direction * head_length, y + head_half}},
        true, {.fill = ink});
}

} // namespace

std::string ticks::label(double v) const
{
    const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 12);
    const std::string s = fmt::format("{:.{}f}", v, decimals);
    return s.find_first_not_of("-0.") == std::string::npos ? s.substr(s[0] == '-' ? 1 : 0) : s;
}

ticks nice_ticks(double lo, double hi, std::size_t most)
{
    ticks t;
    const double span = hi - lo;
    if (!(span > 0.0) || !std::isfinite(span) || most == 0) {
        t.at = {lo};
        return t;
    }
    const double slack = 1e-9 * span;
    double decade = std::pow(10.0, std::floor(std::log10(span / static_cast<double>(most))));
    for (;; decade *= 10.0)
        for (const double factor : {1.0, 2.0, 5.0}) {
            t.step = factor * decade;
            const double first = std::ceil((lo - slack) / t.step);
            const double last = std::floor((hi + slack) / t.step);
            if (last - first + 1.0 > static_cast<double>(most))
                continue;
            for (double k = first; k <= last; k += 1.0)
                t.at.push_back(k * t.step);
            return t;
        }
}

ticks horizontal_ticks(const scale& x, double text_size)
{
    const double length = std::abs(x.page_to - x.page_from);
    ticks t;
    for (std::size_t most = 11; most > 1; --most) {
        t = nice_ticks(x.from, x.to, most);
        double widest = 0.0;
        for (const double v : t.at)
            widest = std::max(widest, text_width(t.label(v), text_size));
        if (t.at.size() < 2 || t.step * std::abs(x.per_unit()) >= widest + 7.0 || widest + 7.0 > length)
            break;
    }
    return t;
}

void draw_horizontal_axis(canvas& c, const scale& x, double y, double grid_top, const std::string& title)
{
    const group g(c, {.kind = "axis",
                      .data = {{"x0", fmt::format("{:.9g}", x(0.0))},
                               {"x-scale", fmt::format("{:.9g}", x.per_unit())}}});
    const ticks t = horizontal_ticks(x, small_text);
    const style thin{.stroke = ink, .width = 0.6};
    for (const double v : t.at)
        if (grid_top < y)
            c.line({x(v), grid_top}, {x(v), y}, {.stroke = light_grey, .width = 0.4}, {.kind = "grid"});
    c.line({x.page_from, y}, {x.page_to, y}, thin);
    for (const double v : t.at) {
        c.line({x(v), y}, {x(v), y + tick_length}, thin, {.kind = "tick"});
        c.text({x(v), y + tick_length + 1.5 + cap_height(small_text)}, t.label(v),
               {.size = small_text, .anchor = align::middle}, {.kind = "tick-label"});
    }
    c.text({(x.page_from + x.page_to) / 2.0, y + axis_height - 2.0}, title,
           {.size = label_text, .anchor = align::middle}, {.kind = "axis-title"});
}

void draw_vertical_axis(canvas& c, const scale& y, const ticks& t, box inside, const std::string& title,
                        double title_x)
{
    const style thin{.stroke = ink, .width = 0.6};
    for (const double v : t.at) {
        c.line({inside.x, y(v)}, {inside.right(), y(v)}, {.stroke = light_grey, .width = 0.4},
               {.kind = "grid"});
        c.line({inside.x - 2.5, y(v)}, {inside.x, y(v)}, thin, {.kind = "tick"});
        c.text({inside.x - 4.0, y(v) + cap_height(small_text) / 2.0}, t.label(v),
               {.size = small_text, .anchor = align::end}, {.kind = "tick-label"});
    }
    c.line({inside.x, inside.y}, {inside.x, inside.bottom()}, thin);
    c.text({title_x, inside.y + inside.height / 2.0}, title,
           {.size = label_text, .anchor = align::middle, .upwards = true}, {.kind = "axis-title"});
}

void draw_dimension(canvas& c, double x0, double x1, double y, double below, const std::string& label,
                    const mark& m)
{
    const group g(c, m);
    const style thin{.stroke = ink, .width = 0.45};
    const style extension{.stroke = dark_grey, .width = 0.35, .dash = 1.0};
    for (const double x : {x0, x1})
        c.line({x, y - 3.0}, {x, below}, extension);
    const double baseline = y + cap_height(small_text) / 2.0;
    const double width = text_width(label, small_text);
    const bool heads_inside = x1 - x0 >= 2.0 * head_length + 1.0;
    const bool label_inside = x1 - x0 >= width + 2.0 * head_length + 8.0;
    if (heads_inside) {
        const double middle = (x0 + x1) / 2.0;
        const double half = label_inside ? width / 2.0 + 2.0 : 0.0;
        c.line({x0, y}, {middle - half, y}, thin);
        c.line({middle + half, y}, {x1, y}, thin);
        draw_head(c, x0, y, -1.0);
        draw_head(c, x1, y, 1.0);
    } else {
        c.line({x0 - head_length - tail, y}, {x0, y}, thin);
        c.line({x1, y}, {x1 + head_length + tail, y}, thin);
        draw_head(c, x0, y, 1.0);
        draw_head(c, x1, y, -1.0);
    }
    if (label_inside)
        c.text({(x0 + x1) / 2.0, baseline}, label,
               {.size = small_text, .anchor = align::middle, .halo = true});
    else
        c.text({x1 + (heads_inside ? 0.0 : head_length + tail) + 2.5, baseline}, label,
               {.size = small_text, .halo = true});
}

void draw_hatch(canvas& c, box b, const mark& m)
{
    const group g(c, m);
    const style thin{.stroke = black, .width = 0.4};
    constexpr double apart = 2.4;
    // Lines x + y = k through the page, so that neighbouring boxes continue each other.
    const double first = std::ceil((b.x + b.y) / apart) * apart;
    for (double k = first; k < b.right() + b.bottom(); k += apart) {
        const double x_top = std::min(b.right(), k - b.y);
        const double x_bottom = std::max(b.x, k - b.bottom());
        c.line({x_bottom, k - x_bottom}, {x_top, k - x_top}, thin);
    }
    c.rect(b, {.stroke = black, .width = 0.5}, {.kind = "rim"});
}

} // namespace tactor::plot
