// SPDX-License-Identifier: MIT
#include "plot/draw/array_frame.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

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
    // Draws numbers in a box of the stroke's colour, because plain numbers are tactors. Returns false if
    // there is no space.
    bool number_start(const std::vector<spot>& starts, std::size_t k, const std::vector<std::size_t>& strokes)
    {
        std::vector<std::size_t> numbers;
        for (const std::size_t i : strokes)
            numbers.push_back(i + 1);
        const std::string text = fmt::format("{}", fmt::join(numbers, ", "));
        const auto place =
            taken_.place_at(" " + text + " ", small_text, starts, k, radius() + 1.5, farthest_number);
        if (!place)
            return false;
        const bool one_look = std::all_of(strokes.begin(), strokes.end(), [&](std::size_t i) {
            return time_.looks[i] == time_.looks[strokes.front()];
        });
        const colour fill = one_look ? stroke_colour(time_.looks[strokes.front()]) : dark_grey;
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
        const auto place = taken_.place_clear(text, label_text, at, radius() + 1.5, farthest_label);
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
