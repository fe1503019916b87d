// SPDX-License-Identifier: MIT
#include "plot/draw/array_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include <tactor/phantom.hpp>

#include "plot/draw/axes.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_avoided = 4000; // in a crowded picture, more would not change the result

// Directions in order of preference: below, right, left, above, then the corners. y points down.
struct direction {
    double x;
    double y;
};
constexpr std::array<direction, 8> directions{
    {{0, 1}, {1, 0}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
constexpr double farther = 1.5;  // step between the distances that are tried, pt
constexpr double clearly = 1.25; // least ratio of the distances to other sites and to the own site

double overlap_area(box a, box b) noexcept
{
    const double w = std::min(a.right(), b.right()) - std::max(a.x, b.x);
    const double h = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
    return w > 0.0 && h > 0.0 ? w * h : 0.0;
}

double distance(box b, spot s) noexcept
{
    return std::hypot(std::max({b.x - s.x, s.x - b.right(), 0.0}),
                      std::max({b.y - s.y, s.y - b.bottom(), 0.0}));
}

constexpr double largest_pitch = 100.0; // largest distance between neighbours on the page, pt
constexpr double lone_tactor_mm = 20.0; // length shown around a tactor without neighbours
constexpr std::size_t most_path_points = 20000;
constexpr double largest_number = 7.0; // size, pt
constexpr double least_number = 5.2;
constexpr double rim = 0.4; // space between a number and its circle
constexpr double largest_radius = 7.0;
constexpr double largest_share = 0.28; // largest ratio of a circle's radius to the distance of neighbours

double pitch_mm(const array& a)
{
    const double p = layout(a).pitch_mm();
    return p > 0.0 ? p : lone_tactor_mm;
}

std::vector<point> sample(const trajectory& motion)
{
    constexpr double step_mm = 0.1;
    const double wanted = std::max(64.0, motion.length_mm() / step_mm);
    const auto n = static_cast<std::size_t>(std::min(wanted, static_cast<double>(most_path_points)));
    std::vector<point> points;
    for (std::size_t i = 0; i <= n; ++i)
        points.push_back(
            motion.position(motion.duration_s() * static_cast<double>(i) / static_cast<double>(n)));
    return points;
}

// Returns the shortest distance between two tactors on the page, pt. It limits the circles, which must not
// touch.
double min_distance_pt(const array& a, double scale)
{
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            least = std::min(least, distance_mm(a.tactors[i].position, a.tactors[k].position));
    return least * scale;
}

// Sets the radius of the circles and the size of their numbers. The longest number fits in a circle; the size
// is 0 if there is no space for legible numbers.
void set_tactor_sizes(array_frame& f, const array& a)
{
    const double space = std::min(f.pitch, min_distance_pt(a, f.scale));
    const std::string longest(fmt::format("{}", a.tactors.size() - 1).size(), '8');
    const double half = std::hypot(text_width(longest, 1.0), cap_height(1.0)) / 2.0; // at a text size of 1 pt
    const double most = std::min(largest_share * space, largest_radius);
    f.number = std::min(largest_number, (most - rim) / half);
    if (f.number < least_number)
        f.number = 0.0;
    f.radius = std::max(std::clamp(0.2 * space, 0.3, largest_radius), f.number * half + rim);
}

} // namespace

void label_placer::block_disc(spot centre, double radius)
{
    block({centre.x - radius, centre.y - radius, 2.0 * radius, 2.0 * radius});
}

void label_placer::avoid_disc(spot centre, double radius)
{
    if (avoided_.size() < most_avoided)
        avoided_.push_back({centre.x - radius, centre.y - radius, 2.0 * radius, 2.0 * radius});
}

std::optional<double> label_placer::cover(box b) const
{
    const auto overlap = [b](box o) { return overlap_area(b, o); };
    if (b.x < area_.x || b.y < area_.y || b.right() > area_.right() || b.bottom() > area_.bottom() ||
        std::ranges::any_of(blocked_, [&](box o) { return overlap(o) > 0.0; }))
        return std::nullopt;
    return std::transform_reduce(avoided_.begin(), avoided_.end(), 0.0, std::plus(), overlap);
}

void label_placer::avoid_line(const std::vector<spot>& line)
{
    constexpr double step = 2.0; // greatest distance between the discs along the line, pt
    for (std::size_t i = 1; i < line.size(); ++i) {
        const spot a = line[i - 1];
        const spot b = line[i];
        const double n = std::min(std::floor(std::hypot(b.x - a.x, b.y - a.y) / step), 200.0) + 1.0;
        for (double k = 0.5; k < n; ++k)
            avoid_disc({a.x + k / n * (b.x - a.x), a.y + k / n * (b.y - a.y)}, 0.5 * step);
    }
}

std::optional<spot> label_placer::place(std::string_view text, double size, const std::vector<spot>& sites,
                                        std::size_t own, double gap, double reach)
{
    constexpr double air = 0.8;
    const double w = text_width(text, size) + 2.0 * air;
    const double h = cap_height(size) + 2.0 * air;
    const spot at = sites[own];
    const auto is_nearest = [&](box b) {
        const double near = clearly * distance(b, at);
        for (std::size_t i = 0; i < sites.size(); ++i)
            if (i != own && distance(b, sites[i]) <= near)
                return false;
        return true;
    };
    std::optional<box> best;
    double least = std::numeric_limits<double>::infinity();
    for (double away = gap - air; away <= gap - air + reach; away += farther)
        for (const direction& d : directions) {
            const box b{at.x + d.x * (away + 0.5 * w) - 0.5 * w, at.y + d.y * (away + 0.5 * h) - 0.5 * h, w,
                        h};
            if (const auto covered = cover(b); covered && *covered < least && is_nearest(b)) {
                least = *covered;
                best = b;
            }
        }
    if (!best)
        return std::nullopt;
    block(*best);
    return spot{best->x + air, best->bottom() - air};
}

void extent::add(point p) noexcept
{
    x0 = std::min(x0, p.x_mm);
    y0 = std::min(y0, p.y_mm);
    x1 = std::max(x1, p.x_mm);
    y1 = std::max(y1, p.y_mm);
}

extent shown_extent(const array& a, const std::vector<stroke>& strokes)
{
    const point first = a.tactors.front().position;
    extent e{first.x_mm, first.y_mm, first.x_mm, first.y_mm};
    for (const tactor_spec& t : a.tactors)
        e.add(t.position);
    const double pitch = pitch_mm(a);
    const double space = std::max({pitch, 0.5 * (e.x1 - e.x0), 0.5 * (e.y1 - e.y0)});
    const extent most{e.x0 - space, e.y0 - space, e.x1 + space, e.y1 + space};
    for (const stroke& s : strokes)
        for (const point& p : sample(s.motion))
            e.add({std::clamp(p.x_mm, most.x0, most.x1), std::clamp(p.y_mm, most.y0, most.y1)});
    if (e.x1 - e.x0 < 0.3 * pitch && e.y1 - e.y0 < 0.3 * pitch) // there is only a single tactor
        e = {e.x0 - 0.2 * space, e.y0 - 0.2 * space, e.x1 + 0.2 * space, e.y1 + 0.2 * space};
    return e;
}

array_frame fit_array(const array& a, const extent& shown, box at_most, spot space)
{
    const double w = shown.x1 - shown.x0;
    const double h = shown.y1 - shown.y0;
    const double pitch = pitch_mm(a);
    array_frame f;
    f.scale = std::min({(at_most.width - 2.0 * space.x) / std::max(w, 1e-3),
                        (at_most.height - 2.0 * space.y) / std::max(h, 1e-3), largest_pitch / pitch});
    f.pitch = pitch * f.scale;
    set_tactor_sizes(f, a);
    f.area.width = f.scale * w + 2.0 * space.x;
    f.area.height = f.scale * h + 2.0 * space.y;
    f.area.x = at_most.x + (at_most.width - f.area.width) / 2.0;
    f.area.y = at_most.y;
    f.origin = {f.area.x + space.x - f.scale * shown.x0, f.area.y + space.y - f.scale * shown.y0};
    return f;
}

std::vector<std::vector<spot>> map_path_to_page(const array_frame& f, const trajectory& motion)
{
    std::vector<spot> line;
    for (const point& p : sample(motion))
        line.push_back(f(p));
    std::vector<std::vector<spot>> parts = clip(line, f.area);
    for (std::vector<spot>& p : parts)
        p = simplify(p, 0.04);
    return parts;
}

bool has_matching_channels(const array& a)
{
    for (unsigned i = 0; i < a.tactors.size(); ++i)
        if (a.tactors[i].channel != i)
            return false;
    return true;
}

void draw_scale_bar(canvas& c, const array_frame& f, spot at)
{
    constexpr double longest = 60.0; // longest bar, pt
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
