// SPDX-License-Identifier: MIT
#include "plot/draw/dimensions.hpp"

#include <algorithm>
#include <cmath>

#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double head_length = 3.6;
constexpr double head_half = 1.3;
constexpr double tail = 4.0; // of an arrow that points from outside

// A head whose tip is at x; direction 1 points to the right.
void draw_head(canvas& c, double x, double y, double direction)
{
    c.poly(
        {{x, y}, {x - direction * head_length, y - head_half}, {x - direction * head_length, y + head_half}},
        true, {.fill = ink});
}

} // namespace

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
