// SPDX-License-Identifier: MIT
#include "plot/array_frame.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <tactor/phantom.hpp>

#include "plot/axes.hpp"
#include "plot/text.hpp"

namespace tactor::plot {
namespace {

constexpr double margin_x = 17.0; // room for labels beside the outer tactors, pt
constexpr double margin_y = 14.0;
constexpr double largest_pitch = 100.0; // pt: neighbours are not farther apart on the page
constexpr double lone_tactor_mm = 20.0; // shown round a tactor without neighbours
constexpr std::size_t most_path_points = 20000;
constexpr std::size_t most_tight_labels = 60;
constexpr std::size_t most_told = 1024; // tactors that get a group with a title of their own

double pitch_mm(const array& a)
{
    const double p = layout(a).pitch_mm();
    return p > 0.0 ? p : lone_tactor_mm;
}

extent tactors_extent(const array& a)
{
    const point first = a.tactors.front().position;
    extent e{first.x_mm, first.y_mm, first.x_mm, first.y_mm};
    for (const tactor_spec& t : a.tactors)
        e.add(t.position);
    return e;
}

std::vector<point> sample(const trajectory& motion)
{
    constexpr double step_mm = 0.1;
    const double wished = std::max(64.0, motion.length_mm() / step_mm);
    const auto n = static_cast<std::size_t>(std::min(wished, static_cast<double>(most_path_points)));
    std::vector<point> points;
    for (std::size_t i = 0; i <= n; ++i)
        points.push_back(
            motion.position(motion.duration_s() * static_cast<double>(i) / static_cast<double>(n)));
    return points;
}

} // namespace

void extent::add(point p) noexcept
{
    x0 = std::min(x0, p.x_mm);
    y0 = std::min(y0, p.y_mm);
    x1 = std::max(x1, p.x_mm);
    y1 = std::max(y1, p.y_mm);
}

extent shown_extent(const array& a, const std::vector<stroke>& strokes)
{
    extent e = tactors_extent(a);
    const double room = std::max({pitch_mm(a), 0.5 * (e.x1 - e.x0), 0.5 * (e.y1 - e.y0)});
    const extent most{e.x0 - room, e.y0 - room, e.x1 + room, e.y1 + room};
    for (const stroke& s : strokes)
        for (const point& p : sample(s.motion))
            e.add({std::clamp(p.x_mm, most.x0, most.x1), std::clamp(p.y_mm, most.y0, most.y1)});
    if (e.x1 - e.x0 < 0.3 * pitch_mm(a) && e.y1 - e.y0 < 0.3 * pitch_mm(a)) // a lone tactor
        e = {e.x0 - 0.2 * room, e.y0 - 0.2 * room, e.x1 + 0.2 * room, e.y1 + 0.2 * room};
    return e;
}

array_frame fit_array(const array& a, const extent& shown, box at_most)
{
    const double w = shown.x1 - shown.x0;
    const double h = shown.y1 - shown.y0;
    const double pitch = pitch_mm(a);
    array_frame f;
    f.scale = std::min({(at_most.width - 2.0 * margin_x) / std::max(w, 1e-3),
                        (at_most.height - 2.0 * margin_y) / std::max(h, 1e-3), largest_pitch / pitch});
    f.pitch = pitch * f.scale;
    f.radius = std::clamp(0.2 * f.pitch, 0.3, 7.0);
    f.area.width = f.scale * w + 2.0 * margin_x;
    f.area.height = f.scale * h + 2.0 * margin_y;
    f.area.x = at_most.x + (at_most.width - f.area.width) / 2.0;
    f.area.y = at_most.y;
    f.origin = {f.area.x + margin_x - f.scale * shown.x0, f.area.y + margin_y - f.scale * shown.y0};
    return f;
}

std::vector<std::vector<spot>> path_on_page(const array_frame& f, const trajectory& motion)
{
    std::vector<spot> line;
    for (const point& p : sample(motion))
        line.push_back(f(p));
    std::vector<std::vector<spot>> parts = clip(line, f.area);
    for (std::vector<spot>& p : parts)
        p = simplify(p, 0.04);
    return parts;
}

void draw_tactors(canvas& c, const array_frame& f, const array& a, const std::vector<bool>& plays,
                  numbering where, label_placer& taken)
{
    const group all(c, {.id = "tactors"});
    const double size = f.radius >= 6.0 ? 7.0 : small_text;
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        const spot at = f(t.position);
        const colour rim = plays[i] ? ink : grey;
        const style look =
            f.radius < 1.5 ? style{.fill = rim} : style{.fill = white, .stroke = rim, .width = 0.7};
        if (a.tactors.size() > most_told) {
            c.circle(at, f.radius, look, {.kind = "tactor"});
            continue;
        }
        taken.block_disc(at, f.radius, 20.0);
        const group one(c, {.id = fmt::format("tactor-{}", i),
                            .kind = "tactor",
                            .title = fmt::format("tactor {}, channel {}, at {}, {} mm", i, t.channel,
                                                 number(t.position.x_mm), number(t.position.y_mm)),
                            .data = {{"tactor", fmt::format("{}", i)}}});
        c.circle(at, f.radius, look);
        if (where == numbering::inside)
            c.text({at.x, at.y + cap_height(size) / 2.0}, fmt::format("{}", i),
                   {.size = size, .anchor = align::middle, .ink = plays[i] ? ink : dark_grey},
                   {.kind = "number"});
    }
}

void draw_tactor_labels(canvas& c, const array_frame& f, const array& a, const std::vector<bool>& plays,
                        numbering where, label_placer& taken)
{
    const bool roomy = f.pitch >= 24.0 && a.tactors.size() <= 200;
    const bool tight = !roomy && f.pitch >= 8.0 && a.tactors.size() <= most_told;
    const group all(c, {.id = "tactor-labels"});
    std::size_t left = most_tight_labels;
    for (unsigned i = 0; i < a.tactors.size() && (roomy || tight); ++i) {
        std::string text = fmt::format("ch {}", a.tactors[i].channel);
        if (tight && (!plays[i] || left-- == 0))
            continue;
        if (tight)
            text = fmt::format("{}", i);
        else if (where == numbering::beside)
            text = fmt::format("{} ({})", i, text);
        c.text(taken.place(text, small_text, f(a.tactors[i].position), f.radius + 1.2), text,
               {.size = small_text, .ink = plays[i] ? ink : dark_grey, .halo = true},
               {.kind = "tactor-label", .data = {{"tactor", fmt::format("{}", i)}}});
    }
}

void draw_scale_bar(canvas& c, const array_frame& f, spot at)
{
    constexpr double longest = 60.0; // pt
    const double mm = nice_ticks(0.0, longest / f.scale, 3).step;
    const double length = mm * f.scale;
    const std::string text = fmt::format("{} mm", number(mm, 6));
    const group g(c, {.id = "scale-bar",
                      .title = fmt::format("scale: this bar is {}", text),
                      .data = {{"mm", fmt::format("{:.9g}", mm)}}});
    const style look{.stroke = ink, .width = 1.0};
    c.line(at, {at.x + length, at.y}, look, {.kind = "bar"});
    for (const double x : {at.x, at.x + length})
        c.line({x, at.y - 2.0}, {x, at.y + 2.0}, {.stroke = ink, .width = 0.7});
    c.text({at.x + length + 4.0, at.y + cap_height(small_text) / 2.0}, text, {.size = small_text});
}

} // namespace tactor::plot
