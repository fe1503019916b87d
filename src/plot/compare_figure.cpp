// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/words.hpp"
#include "plot/draw/array_frame.hpp"
#include "plot/draw/axes.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

using detail::comparison_row;

constexpr double chart_height = 105.0;
constexpr double scale_height = 12.0;
constexpr std::size_t most_dots = 400;
constexpr std::size_t most_points = 20000;

// Styles of lines, one for each algorithm in order. They differ in hue, lightness and dashes.
constexpr std::array<style, 3> looks{style{.stroke = blue, .width = 0.9},
                                     style{.stroke = vermilion, .width = 0.9, .dash = 3.0},
                                     style{.stroke = ink, .width = 0.9, .dash = 1.1}};

// The array, the target and the part of the skin that all panels show.
struct panel_ground {
    const array& tactors;
    const stroke& target;
    extent shown;
};

// Style of the target's line in panels and charts.
constexpr style target_look{.stroke = light_grey, .width = 2.6};

// Line of the felt position, and the places at which it rests. Only bursts have such places.
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
        const bool rests = last == x.felt;
        if (!rests)
            t.line.push_back(f(*x.felt));
        else if (!rested)
            t.rests.push_back(f(*x.felt));
        rested = rests;
        last = x.felt;
    }
    // A burst at the end has only one sample, so add its place here.
    if (!t.rests.empty() && !rested)
        t.rests.push_back(t.line.back());
    const std::size_t stride = t.line.size() / most_points + 1;
    std::vector<spot> fewer;
    for (std::size_t i = 0; i < t.line.size(); i += stride)
        fewer.push_back(t.line[i]);
    t.line = simplify(fewer, 0.04);
    return t;
}

// Returns the felt places of taps, as a track.
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
    // If dots are close, their white rims would cover other dots.
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
    constexpr double share =
        0.65; // size of circles relative to a picture of a single array, because panels are close together
    const double radius = share * f.radius;
    const double number = share * f.number;
    for (std::size_t i = 0; i < g.tactors.tactors.size(); ++i) {
        const spot at = f(g.tactors.tactors[i].position);
        c.circle(at, radius, {.fill = white, .stroke = grey, .width = std::min(0.5, 0.3 * radius)},
                 {.kind = "tactor"});
        if (number > 0.0)
            c.text({at.x, at.y + cap_height(number) / 2.0}, fmt::format("{}", i),
                   {.size = number, .anchor = align::middle, .ink = dark_grey}, {.kind = "number"});
    }
    for (std::vector<spot>& part : map_path_to_page(f, g.target.motion))
        c.poly(std::move(part), false, target_look, {.kind = "target"});
    c.circle(f(g.target.motion.position(0.0)), 2.2, {.fill = white, .stroke = ink, .width = 0.7},
             {.kind = "start", .title = "start"});
}

// Returns the values of a prediction as text. For taps, the length replaces the speed.
std::array<std::string, 4> facts(const comparison_row& p)
{
    const auto text = [](const std::optional<double>& v) { return v ? fmt::format("{:.2f}", *v) : "-"; };
    return {
        fmt::format("{} mm from path", text(p.felt.rms_to_path_mm)),
        fmt::format("RMS {} mm", text(p.felt.rms_error_mm)),
        fmt::format("lag {:.0f} ms: {} mm", 1000.0 * p.felt.lag_s.value_or(0.0), text(p.felt.rms_at_lag_mm)),
        p.taps.empty() ? fmt::format("speed CV {}", text(p.felt.speed_cv))
                       : fmt::format("length {} of target", text(p.tapped.length_ratio))};
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

// Returns the position of the array in a panel. All panels of the same size have the same scale.
array_frame panel_frame(const panel_ground& g, box where)
{
    return fit_array(g.tactors, g.shown, where, {8.0, 8.0}); // panels need no space for labels
}

// Draws a panel at the top of a box. The panel shows the target and, in the style of the algorithm, the
// predicted percept. Returns the panel's height.
double draw_panel(canvas& c, const panel_ground& g, const comparison_row& p, const style& look, box where)
{
    const std::string algorithm(to_string(p.algorithm));
    const std::string phantom(to_string(p.phantom));
    const group one(c, {.id = fmt::format("panel-{}-{}", algorithm, phantom),
                        .kind = "panel",
                        .data = {{"algorithm", algorithm}, {"phantom", phantom}}});
    double y = where.y + cap_height(label_text);
    c.text({where.x, y}, algorithm, {.size = label_text, .bold = true});
    const std::string missing = p.refused               ? fmt::format("refused: {}", p.refused->why())
                                : p.unpredicted.empty() ? ""
                                                        : "no prediction: " + p.unpredicted;
    if (!missing.empty())
        return y + 2.5 - where.y +
               draw_wrapped_text(c, missing, {where.x, y + 2.5, where.width - 6.0, 0.0}, 12, "refused");
    y += 2.5;
    for (const std::string& fact : facts(p))
        y += draw_wrapped_text(c, fact, {where.x, y, where.width - 4.0, 0.0}, 2, "facts");
    const array_frame f = panel_frame(g, {where.x, y, where.width, where.height});
    draw_ground(c, g, f);
    if (p.spread)
        draw_people(c, p.spread->tracks, f, look);
    draw_track(c, !p.taps.empty() ? follow(f, p.taps) : follow(f, p.samples), look);
    return f.area.bottom() - where.y;
}

// Returns the distinct values of a member, in the order in which they appear.
template <class Kind>
std::vector<Kind> list_distinct(const std::vector<comparison_row>& all, Kind comparison_row::*member)
{
    std::vector<Kind> list;
    for (const comparison_row& r : all)
        if (std::find(list.begin(), list.end(), r.*member) == list.end())
            list.push_back(r.*member);
    return list;
}

series felt_speed(const comparison_row& p, const style& look)
{
    series s{std::string(to_string(p.algorithm)), {}, look};
    s.values.reserve(p.samples.size());
    for (const percept_sample& x : p.samples)
        s.values.push_back({x.t_s, x.speed_mm_s.value_or(std::numeric_limits<double>::quiet_NaN())});
    return s;
}

series target_speed(const std::vector<percept_sample>& samples)
{
    series s{"target", {}, target_look};
    for (std::size_t i = 1; i + 1 < samples.size(); ++i)
        s.values.push_back({samples[i].t_s, distance_mm(samples[i + 1].target, samples[i - 1].target) /
                                                (samples[i + 1].t_s - samples[i - 1].t_s)});
    return s;
}

// Returns the speeds between consecutive taps. The time of a speed is halfway between the two onsets.
series chain_speed(const std::string& name, const std::vector<tap>& taps, point tap::*place,
                   const style& look)
{
    series s{name, {}, look};
    for (std::size_t i = 1; i < taps.size(); ++i)
        if (taps[i].onset_s > taps[i - 1].onset_s)
            s.values.push_back(
                {(taps[i].onset_s + taps[i - 1].onset_s) / 2.0,
                 distance_mm(taps[i].*place, taps[i - 1].*place) / (taps[i].onset_s - taps[i - 1].onset_s)});
    return s;
}

// Adds the line of a prediction. If it is the first line, adds the line of the target before it.
void add_speeds(std::vector<series>& lines, const comparison_row& p, const style& look)
{
    const bool by_taps = !p.taps.empty();
    if (p.refused || !p.unpredicted.empty())
        return;
    if (lines.empty())
        lines.push_back(by_taps ? chain_speed("target", p.taps, &tap::target, target_look)
                                : target_speed(p.samples));
    lines.push_back(by_taps ? chain_speed(std::string(to_string(p.algorithm)), p.taps, &tap::felt, look)
                            : felt_speed(p, look));
}

// Returns the upper end of the vertical axis of a chart.
double axis_end(const chart& ch)
{
    double largest = 0.0;
    for (const series& s : ch.lines)
        for (const spot& v : s.values)
            largest = std::isfinite(v.y) ? std::max(largest, v.y) : largest;
    for (const chart_band& b : ch.bands)
        for (const spot& v : b.high)
            largest = std::max(largest, v.y);
    return largest > 0.0 ? 1.05 * largest : 1.0;
}

chart_band make_band(const comparison_row& p, const style& look)
{
    chart_band b{
        std::string(to_string(p.algorithm)), {}, {}, {.fill = with_alpha(look.stroke.value_or(ink), 0.18)}};
    for (const detail::speed_range& r : p.spread->speeds) {
        b.low.push_back({r.t_s, r.low});
        b.high.push_back({r.t_s, r.high});
    }
    return b;
}

// Draws the panels of a phantom model, and below them the chart of speeds.
double draw_row(canvas& c, const panel_ground& g, const std::vector<comparison_row>& all,
                const std::vector<algorithm_kind>& algorithms, phantom_kind phantom, bool first, box where)
{
    double y = where.y + cap_height(title_text);
    c.text({where.x, y}, fmt::format("phantom: {}", to_string(phantom)), {.size = title_text, .bold = true});
    y += 5.0;
    const double width = where.width / static_cast<double>(algorithms.size());
    double tallest = 0.0;
    chart speeds{.id = fmt::format("speed-{}", to_string(phantom)),
                 .x_to = g.target.motion.duration_s(),
                 .y_title = "speed (mm/s)"};
    for (const comparison_row& p : all) {
        if (p.phantom != phantom)
            continue;
        const auto column = static_cast<std::size_t>(
            std::find(algorithms.begin(), algorithms.end(), p.algorithm) - algorithms.begin());
        const style& look = looks[column % looks.size()];
        const box cell{where.x + width * static_cast<double>(column), y, width, std::min(width, 260.0)};
        tallest = std::max(tallest, draw_panel(c, g, p, look, cell));
        add_speeds(speeds.lines, p, look);
        if (p.spread && !p.spread->speeds.empty())
            speeds.bands.push_back(make_band(p, look));
    }
    y += tallest;
    if (first) { // the scale is the same for all panels
        draw_scale_bar(c, panel_frame(g, {where.x, y, width, std::min(width, 260.0)}),
                       {where.x, y + scale_height / 2.0});
        y += scale_height;
    }
    if (!speeds.lines.empty()) {
        speeds.where = {where.x, y + 2.0, where.width, chart_height};
        speeds.y_to = axis_end(speeds);
        draw_chart(c, speeds);
        y += chart_height;
    }
    return y + 8.0 - where.y;
}

std::string note(const detail::comparison& c)
{
    const bool taps = c.observer.kind == observer_kind::low_speed;
    std::string text = fmt::format("The ring is the start; dots are where {}",
                                   taps ? "each burst is felt" : "the felt position rests");
    if (c.spread.people != 0)
        text += "; light lines and bands: " + spread_note(c.spread, taps);
    text += ". This is " + prediction_note(c.observer) + ".";
    if (c.compensated)
        text += " Bursts are moved for " + describe(c.observer.low_speed) + ".";
    if (c.faces == faces_kind::nearest)
        text += " With inverse-distance the three closest tactors play (faces nearest).";
    return text;
}

} // namespace

canvas draw_comparison(const array& a, const detail::comparison& all, const std::string& title,
                       double width_mm)
{
    canvas c = make_canvas(width_mm);
    c.title = fmt::format("{} on {}: predicted percepts", clean(all.target.name), clean(a.name));
    c.description = note(all);
    const panel_ground g{a, all.target, shown_extent(a, {all.target})};
    const std::vector<algorithm_kind> algorithms = list_distinct(all.rows, &comparison_row::algorithm);
    box rest{margin, margin, c.width - 2.0 * margin, 0.0};
    if (!title.empty()) {
        const trajectory& m = all.target.motion;
        const std::string facts =
            fmt::format("on {}, {} mm in {}", clean(a.name), plain_number(m.length_mm(), 4),
                        seconds_text(m.duration_s(), 4));
        rest.y += draw_heading(c, clean(title), facts, rest) + 4.0;
    }
    const std::vector<phantom_kind> phantoms = list_distinct(all.rows, &comparison_row::phantom);
    for (const phantom_kind phantom : phantoms)
        rest.y += draw_row(c, g, all.rows, algorithms, phantom, phantom == phantoms.front(), rest);
    rest.y += draw_wrapped_text(c, c.description, rest, 9, "note");
    c.height = rest.y + margin;
    return c;
}

} // namespace tactor::plot
