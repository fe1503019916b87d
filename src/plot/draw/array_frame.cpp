// SPDX-License-Identifier: MIT
#include "plot/draw/array_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/phantom.hpp>

#include "core/words.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double largest_pitch = 100.0; // pt: neighbours are not farther apart on the page
constexpr double lone_tactor_mm = 20.0; // shown around a tactor without neighbours
constexpr std::size_t most_path_points = 20000;
constexpr double largest_number = 7.0; // pt
constexpr double least_number = 5.2;
constexpr double rim = 0.4; // between a number and its circle
constexpr double largest_radius = 7.0;
constexpr double largest_share = 0.28; // of the distance of neighbours, for a circle's radius
constexpr double beside = 3.0;         // pt: farther away a label has lost its tactor

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
    const double wanted = std::max(64.0, motion.length_mm() / step_mm);
    const auto n = static_cast<std::size_t>(std::min(wanted, static_cast<double>(most_path_points)));
    std::vector<point> points;
    for (std::size_t i = 0; i <= n; ++i)
        points.push_back(
            motion.position(motion.duration_s() * static_cast<double>(i) / static_cast<double>(n)));
    return points;
}

// Returns the shortest distance of two tactors, pt: circles must not touch.
double closest_pt(const array& a, double scale)
{
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            least = std::min(least, distance_mm(a.tactors[i].position, a.tactors[k].position));
    return least * scale;
}

// Sizes circles so that the largest number fits, if there is space for that.
void size_tactors(array_frame& f, const array& a)
{
    const double space = std::min(f.pitch, closest_pt(a, f.scale));
    const std::string longest(fmt::format("{}", a.tactors.size() - 1).size(), '8');
    const double half = std::hypot(text_width(longest, 1.0), cap_height(1.0)) / 2.0; // for a size of 1 pt
    const double most = std::min(largest_share * space, largest_radius);
    f.number = std::min(largest_number, (most - rim) / half);
    if (f.number < least_number)
        f.number = 0.0;
    f.radius = std::max(std::clamp(0.2 * space, 0.3, largest_radius), f.number * half + rim);
}

std::string note_missing(std::size_t n, const array& a)
{
    return n == 0                  ? ""
           : n == a.tactors.size() ? "no space for the numbers of the tactors"
                                   : "no space for the number of " + counted(n, "tactor");
}

constexpr double arrow_length = 4.6;
constexpr double arrow_half_width = 2.1;
constexpr double arrow_every = 75.0;    // pt along the path
constexpr std::size_t most_arrows = 60; // in a picture
constexpr double farthest_number = 7.0;
constexpr double same_start = 1.0;      // pt
constexpr double farthest_label = 20.0; // from a start or end, pt
constexpr std::size_t most_marked = 60; // strokes with marked ends

class marker {
public:
    marker(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
           label_placer& taken)
        : canvas_(c), scene_(s), time_(t), frame_(f), dot_(dot), taken_(taken)
    {
    }

    void draw()
    {
        const std::size_t n = std::min(scene_.strokes.size(), most_marked);
        for (std::size_t i = 0; i < n; ++i)
            draw_ends(i);
        for (std::size_t i = 0; i < n; ++i)
            draw_arrows(scene_.strokes[i].motion, n);
    }

    std::string label()
    {
        if (scene_.strokes.size() == 1) {
            const trajectory& motion = scene_.strokes[0].motion;
            const bool start = label("start", "start-label", motion.position(0.0));
            const bool end = label("end", "end-label", motion.position(motion.duration_s()));
            return start && end ? "" : "the ring is the start, the square the end";
        }
        std::vector<spot> starts;
        std::vector<std::vector<std::size_t>> strokes; // that start there
        std::size_t left_out = 0;
        for (std::size_t i = 0; i < scene_.strokes.size(); ++i) {
            const spot at = frame_(scene_.strokes[i].motion.position(0.0));
            const auto same = std::find_if(starts.begin(), starts.end(), [&](spot s) {
                return std::hypot(s.x - at.x, s.y - at.y) < same_start;
            });
            if (!on_page(at) || i >= most_marked) {
                ++left_out;
            } else if (same != starts.end()) {
                strokes[static_cast<std::size_t>(same - starts.begin())].push_back(i);
            } else {
                starts.push_back(at);
                strokes.push_back({i});
            }
        }
        for (std::size_t k = 0; k < starts.size(); ++k)
            left_out += number_start(starts, k, strokes[k]) ? 0 : strokes[k].size();
        return left_out == 0 ? "" : "no space for the number of " + counted(left_out, "stroke");
    }

private:
    // Draws numbers in a box of the first stroke's colour, because plain numbers are tactors. Returns false
    // if there is no space.
    bool number_start(const std::vector<spot>& starts, std::size_t k, const std::vector<std::size_t>& strokes)
    {
        std::vector<std::size_t> numbers;
        for (const std::size_t i : strokes)
            numbers.push_back(i + 1);
        const std::string text = fmt::format("{}", fmt::join(numbers, ", "));
        const auto place =
            taken_.place(" " + text + " ", small_text, starts, k, radius() + 1.5, farthest_number);
        if (!place)
            return false;
        const colour fill = stroke_colour(time_.looks[strokes.front()]);
        const double height = cap_height(small_text);
        const double pad = text_width(" ", small_text);
        const double air = 1.3;
        canvas_.rect(
            {place->x, place->y - height - air, text_width(text, small_text) + 2.0 * pad, height + 2.0 * air},
            {.fill = fill, .stroke = white, .width = 0.5}, {.kind = "start-box"});
        canvas_.text({place->x + pad, place->y}, text,
                     {.size = small_text, .ink = is_dark(fill) ? white : black}, {.kind = "start-label"});
        return true;
    }

    static bool is_dark(colour c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b < 140.0; }

    bool on_page(spot s) const
    {
        return s.x >= frame_.area.x && s.x <= frame_.area.right() && s.y >= frame_.area.y &&
               s.y <= frame_.area.bottom();
    }

    box arrow_box(spot at) const
    {
        const double r = arrow_length / 2.0 + 0.7;
        return {at.x - r, at.y - r, 2.0 * r, 2.0 * r};
    }

    // Returns the time near `wanted` at which an arrow covers least.
    double clear_time(const trajectory& motion, double wanted, double range) const
    {
        constexpr int tries = 40;
        double best = wanted;
        double least = taken_.cost(arrow_box(frame_(motion.position(wanted))));
        for (int k = 1; k <= tries; ++k)
            for (const double side : {1.0, -1.0}) {
                const double t = wanted + side * range * k / tries;
                const double c = taken_.cost(arrow_box(frame_(motion.position(t)))) + 1.0 * k;
                if (c < least) {
                    least = c;
                    best = t;
                }
            }
        return best;
    }

    void draw_arrow(const trajectory& motion, double wanted, double range)
    {
        const double t = clear_time(motion, wanted, range);
        const double step = 1e-3 * motion.duration_s();
        const spot from = frame_(motion.position(t - step));
        const spot to = frame_(motion.position(t + step));
        const spot at = frame_(motion.position(t));
        const double length = std::hypot(to.x - from.x, to.y - from.y);
        if (length < 1e-6 || !on_page(at))
            return; // the target rests
        const spot along{(to.x - from.x) / length, (to.y - from.y) / length};
        const auto corner = [&](double forward, double aside) {
            return spot{at.x + forward * along.x - aside * along.y,
                        at.y + forward * along.y + aside * along.x};
        };
        taken_.block(arrow_box(at), 8.0);
        canvas_.poly({corner(arrow_length / 2.0, 0.0), corner(-arrow_length / 2.0, arrow_half_width),
                      corner(-arrow_length / 2.0, -arrow_half_width)},
                     true, {.fill = ink, .stroke = white, .width = 0.4}, {.kind = "direction"});
    }

    void draw_arrows(const trajectory& motion, std::size_t strokes)
    {
        const auto wanted = std::max(1L, std::lround(motion.length_mm() * frame_.scale / arrow_every));
        const std::size_t n =
            std::min({static_cast<std::size_t>(wanted), most_arrows / strokes, most_arrows / 6});
        const double each = motion.duration_s() / static_cast<double>(n);
        for (std::size_t k = 0; k < n; ++k)
            draw_arrow(motion, (static_cast<double>(k) + 0.5) * each, 0.4 * each);
    }

    double radius() const { return end_mark_radius(dot_); }

    void draw_ends(std::size_t stroke)
    {
        const trajectory& motion = scene_.strokes[stroke].motion;
        const spot start = frame_(motion.position(0.0));
        const spot end = frame_(motion.position(motion.duration_s()));
        const style look{.stroke = ink, .width = 0.9};
        const double r = radius();
        if (on_page(start))
            canvas_.circle(start, r, look, {.kind = "start"});
        if (on_page(end))
            canvas_.rect({end.x - r, end.y - r, 2.0 * r, 2.0 * r}, look, {.kind = "end"});
        taken_.block_disc(start, r, 12.0);
        taken_.block_disc(end, r, 12.0);
    }

    // Labels a place. Returns false if there is no space.
    bool label(const std::string& text, const char* kind, point where)
    {
        const spot at = frame_(where);
        if (!on_page(at))
            return true;
        const auto place = taken_.place(text, label_text, {at}, 0, radius() + 1.5, farthest_label);
        if (place)
            canvas_.text(*place, text, {.size = label_text, .halo = true}, {.kind = kind});
        return place.has_value();
    }

    canvas& canvas_;
    const scene& scene_;
    const timeline& time_;
    const array_frame& frame_;
    double dot_;
    label_placer& taken_;
};

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
    const double space = std::max({pitch_mm(a), 0.5 * (e.x1 - e.x0), 0.5 * (e.y1 - e.y0)});
    const extent most{e.x0 - space, e.y0 - space, e.x1 + space, e.y1 + space};
    for (const stroke& s : strokes)
        for (const point& p : sample(s.motion))
            e.add({std::clamp(p.x_mm, most.x0, most.x1), std::clamp(p.y_mm, most.y0, most.y1)});
    if (e.x1 - e.x0 < 0.3 * pitch_mm(a) && e.y1 - e.y0 < 0.3 * pitch_mm(a)) // a lone tactor
        e = {e.x0 - 0.2 * space, e.y0 - 0.2 * space, e.x1 + 0.2 * space, e.y1 + 0.2 * space};
    return e;
}

array_frame fit_array(const array& a, const extent& shown, box at_most, surround space)
{
    const double w = shown.x1 - shown.x0;
    const double h = shown.y1 - shown.y0;
    const double pitch = pitch_mm(a);
    array_frame f;
    f.scale = std::min({(at_most.width - 2.0 * space.x) / std::max(w, 1e-3),
                        (at_most.height - 2.0 * space.y) / std::max(h, 1e-3), largest_pitch / pitch});
    f.pitch = pitch * f.scale;
    size_tactors(f, a);
    f.area.width = f.scale * w + 2.0 * space.x;
    f.area.height = f.scale * h + 2.0 * space.y;
    f.area.x = at_most.x + (at_most.width - f.area.width) / 2.0;
    f.area.y = at_most.y;
    f.origin = {f.area.x + space.x - f.scale * shown.x0, f.area.y + space.y - f.scale * shown.y0};
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

bool channels_are_numbers(const array& a)
{
    for (unsigned i = 0; i < a.tactors.size(); ++i)
        if (a.tactors[i].channel != i)
            return false;
    return true;
}

void draw_tactors(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                  label_placer& taken)
{
    const group all(c, {.id = "tactors"});
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        const spot at = f(t.position);
        const colour rim = looks.plays[i] ? ink : grey;
        const style look =
            f.radius < 1.5 ? style{.fill = rim} : style{.fill = white, .stroke = rim, .width = 0.7};
        taken.block_disc(at, f.radius, label_placer::forbidden);
        const group one(c, {.id = fmt::format("tactor-{}", i),
                            .kind = "tactor",
                            .title = fmt::format("tactor {}, channel {}, at {}, {} mm", i, t.channel,
                                                 number(t.position.x_mm), number(t.position.y_mm)),
                            .data = {{"tactor", fmt::format("{}", i)}}});
        c.circle(at, f.radius, look);
        if (looks.inside[i])
            c.text({at.x, at.y + cap_height(f.number) / 2.0}, fmt::format("{}", i),
                   {.size = f.number, .anchor = align::middle, .ink = looks.plays[i] ? ink : dark_grey},
                   {.kind = "number"});
    }
}

std::string draw_tactor_labels(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                               label_placer& taken)
{
    const group all(c, {.id = "tactor-labels"});
    const bool channels = !channels_are_numbers(a);
    std::vector<spot> sites;
    for (const tactor_spec& t : a.tactors)
        sites.push_back(f(t.position));
    std::size_t missing = 0;
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const std::string channel = channels ? fmt::format("ch {}", a.tactors[i].channel) : "";
        const std::string text = looks.inside[i] ? channel
                                 : channels      ? fmt::format("{} ({})", i, channel)
                                                 : fmt::format("{}", i);
        if (text.empty())
            continue;
        const auto at = taken.place(text, small_text, sites, i, f.radius + 1.2, beside);
        if (at)
            c.text(*at, text, {.size = small_text, .ink = looks.plays[i] ? ink : dark_grey, .halo = true},
                   {.kind = "tactor-label", .data = {{"tactor", fmt::format("{}", i)}}});
        else
            ++missing;
    }
    return note_missing(missing, a);
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

void draw_path_marks(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
                     label_placer& taken)
{
    marker(c, s, t, f, dot, taken).draw();
}

std::string label_strokes(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
                          label_placer& taken)
{
    return marker(c, s, t, f, dot, taken).label();
}

} // namespace tactor::plot
