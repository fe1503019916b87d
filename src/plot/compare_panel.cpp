// SPDX-License-Identifier: MIT
#include "plot/compare_figure.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/split.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double number_size = 5.2; // of tactors, pt
constexpr double most_radius = 5.5; // panels lie close together
constexpr std::size_t most_dots = 400;
constexpr std::size_t most_points = 20000;

// Line of the felt position, and the places at which it rests, which only bursts have.
struct track {
    std::vector<spot> line = {};
    std::vector<spot> rests = {};
};

track follow(const array_frame& f, const std::vector<percept_sample>& samples)
{
    track t;
    std::optional<point> last;
    bool rested = false;
    for (const percept_sample& x : samples) {
        if (!x.felt)
            continue;
        if (last == x.felt) {
            if (!rested)
                t.rests.push_back(f(*x.felt));
            rested = true;
            continue;
        }
        rested = false;
        last = x.felt;
        t.line.push_back(f(*x.felt));
    }
    // A burst at the very end has only one sample.
    if (!t.rests.empty() && !rested && !t.line.empty())
        t.rests.push_back(t.line.back());
    const std::size_t stride = t.line.size() / most_points + 1;
    std::vector<spot> fewer;
    for (std::size_t i = 0; i < t.line.size(); i += stride)
        fewer.push_back(t.line[i]);
    t.line = simplify(fewer, 0.04);
    return t;
}

// Returns the places at which taps are felt.
track follow(const array_frame& f, const std::vector<tap>& taps)
{
    track t;
    for (const tap& x : taps)
        t.line.push_back(f(x.felt));
    t.rests = t.line;
    return t;
}

void draw_track(canvas& c, const track& t, const style& look)
{
    if (t.line.size() > 1)
        c.poly(t.line, false, look, {.kind = "felt"});
    if (t.rests.size() > most_dots)
        return;
    // White rims of close dots would cover the dots.
    double length = 0.0;
    for (std::size_t i = 1; i < t.line.size(); ++i)
        length += std::hypot(t.line[i].x - t.line[i - 1].x, t.line[i].y - t.line[i - 1].y);
    const bool close = length < 2.6 * static_cast<double>(t.rests.size());
    const style dot =
        close ? style{.fill = look.stroke} : style{.fill = look.stroke, .stroke = white, .width = 0.25};
    for (const spot& s : t.rests)
        c.circle(s, close ? 0.8 : 1.3, dot, {.kind = "felt-at"});
}

void draw_ground(canvas& c, const panel_ground& g, const array_frame& f)
{
    const std::string longest(fmt::format("{}", g.tactors.tactors.size() - 1).size(), '8');
    const double need = std::hypot(text_width(longest, number_size), cap_height(number_size)) / 2.0 + 0.4;
    const bool numbered = need < std::min(most_radius, 0.4 * f.pitch);
    const double radius = numbered ? need : std::min(0.55 * f.radius, 3.0);
    for (std::size_t i = 0; i < g.tactors.tactors.size(); ++i) {
        const spot at = f(g.tactors.tactors[i].position);
        c.circle(at, radius, {.fill = white, .stroke = grey, .width = std::min(0.5, 0.3 * radius)},
                 {.kind = "tactor"});
        if (numbered)
            c.text({at.x, at.y + cap_height(number_size) / 2.0}, fmt::format("{}", i),
                   {.size = number_size, .anchor = align::middle, .ink = dark_grey}, {.kind = "number"});
    }
    for (std::vector<spot>& part : path_on_page(f, g.target.motion))
        c.poly(std::move(part), false, target_look, {.kind = "target"});
    c.circle(f(g.target.motion.position(0.0)), 2.2, {.fill = white, .stroke = ink, .width = 0.7},
             {.kind = "start", .title = "start"});
}

std::string figures(const percept_summary& s, bool error, double width)
{
    const std::optional<double> v = error ? s.rms_error_mm : s.speed_cv;
    const std::string text = v ? fmt::format("{:.2f}", *v) : "-";
    if (!error)
        return fmt::format("speed CV {}", text);
    const std::string full = fmt::format("RMS error {} mm", text);
    return text_width(full, small_text) < width ? full : fmt::format("RMS {} mm", text);
}

void draw_people(canvas& c, const std::vector<std::vector<point>>& tracks, const array_frame& f,
                 const style& look)
{
    const style light{.stroke = with_alpha(look.stroke.value_or(ink), 0.12), .width = 0.5};
    for (const std::vector<point>& felt : tracks) {
        std::vector<spot> line;
        for (const point& at : felt)
            line.push_back(f(at));
        c.poly(simplify(line, 0.1), false, light, {.kind = "person"});
    }
}

// Returns a line under the panel's name, for the low-speed observer: error or length.
std::string tap_figures(const detail::comparison_row& p, bool error, double width)
{
    if (error)
        return figures(p.felt, true, width);
    const std::optional<double>& ratio = p.tapped.length_ratio;
    return fmt::format("length {} of target", ratio ? fmt::format("{:.2f}", *ratio) : "-");
}

} // namespace

array_frame panel_frame(const panel_ground& g, box where)
{
    return fit_array(g.tactors, g.shown, where, {6.0, 6.0}); // panels have no labels
}

double draw_words(canvas& c, const std::string& text, box where, std::size_t most_lines, const char* kind)
{
    std::vector<std::string> words;
    for (const std::string_view word : detail::split(text, ' '))
        words.push_back(clean(word));
    double y = where.y;
    for (const std::string& line : wrap(words, " ", small_text, where.width, most_lines)) {
        y += line_pitch;
        c.text({where.x, y}, line, {.size = small_text, .ink = dark_grey}, {.kind = kind});
    }
    return y - where.y;
}

double draw_panel(canvas& c, const panel_ground& g, const detail::comparison_row& p, const style& look,
                  box where)
{
    const std::string algorithm(to_string(p.algorithm));
    const std::string phantom(to_string(p.phantom));
    const group one(c, {.id = fmt::format("panel-{}-{}", algorithm, phantom),
                        .kind = "panel",
                        .data = {{"algorithm", algorithm}, {"phantom", phantom}}});
    double y = where.y + cap_height(label_text);
    c.text({where.x, y}, algorithm, {.size = label_text, .bold = true});
    if (p.refused) {
        y += draw_words(c, fmt::format("refused: {}", p.refused->why()), {where.x, y, where.width - 6.0, 0.0},
                        12, "refused");
        return y - where.y;
    }
    if (!p.unpredicted.empty()) {
        y += draw_words(c, "no prediction: " + p.unpredicted, {where.x, y, where.width - 6.0, 0.0}, 12,
                        "refused");
        return y - where.y;
    }
    const bool by_taps = !p.taps.empty();
    for (const bool error : {true, false}) {
        y += line_pitch;
        const double width = where.width - 4.0;
        c.text({where.x, y}, by_taps ? tap_figures(p, error, width) : figures(p.felt, error, width),
               {.size = small_text, .ink = dark_grey});
    }
    y += 2.0;
    const array_frame f = panel_frame(g, {where.x, y, where.width, where.height});
    draw_ground(c, g, f);
    if (p.spread)
        draw_people(c, p.spread->tracks, f, look);
    draw_track(c, by_taps ? follow(f, p.taps) : follow(f, p.samples), look);
    return f.area.bottom() - where.y;
}

} // namespace tactor::plot
