// SPDX-License-Identifier: MIT
#include "plot/draw/time_colours.hpp"

namespace tactor::plot {

colour colour_of(const timeline& t, const shown_burst& b) noexcept
{
    return t.several() ? of_stroke(t.looks[b.stroke])
                       : ordered(t.total_s > 0.0 ? b.target_s / t.total_s : 0.0);
}

void draw_time_strip(canvas& c, const timeline&, box where)
{
    constexpr int steps = 128;
    const group g(c, {.id = "time-colours", .title = "colour of each time"});
    // Each reaches to the end, so that no seam shows between two.
    for (int i = 0; i < steps; ++i) {
        const double part = static_cast<double>(i) / steps;
        c.rect({where.x + part * where.width, where.y, (1.0 - part) * where.width, where.height},
               {.fill = ordered((i + 0.5) / steps)});
    }
    c.rect(where, {.stroke = ink, .width = 0.4});
}

} // namespace tactor::plot
