// SPDX-License-Identifier: MIT
#include "plot/draw/axes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

constexpr double tick_length = 2.5;
constexpr double legend_row = 9.0;
constexpr double sample_length = 14.0;
constexpr double left_column = 30.0; // space for the labels of the y axis, pt
constexpr double column = 0.25;      // pt; values whose x differs by less are in one column

// Returns a line with at most four points in each column of the page: the first, the least, the greatest and
// the last.
std::vector<spot> thin_out(const std::vector<spot>& line)
{
    std::vector<spot> out;
    for (std::size_t i = 0; i < line.size();) {
        std::size_t end = i;
        std::size_t low = i;
        std::size_t high = i;
        while (end < line.size() && std::isfinite(line[end].y) &&
               std::floor(line[end].x / column) == std::floor(line[i].x / column)) {
            low = line[end].y < line[low].y ? end : low;
            high = line[end].y > line[high].y ? end : high;
            ++end;
        }
        if (end - i <= 4) {
            end = std::max(end, i + 1);
            out.insert(out.end(), line.begin() + static_cast<std::ptrdiff_t>(i),
                       line.begin() + static_cast<std::ptrdiff_t>(end));
        } else {
            for (const std::size_t k : {i, std::min(low, high), std::max(low, high), end - 1})
                out.push_back(line[k]);
        }
        i = end;
    }
    return out;
}

struct segment {
    spot from;
    spot to;
};

// Returns the part of a segment that is inside a box (Liang and Barsky).
std::optional<segment> clip_segment(spot a, spot b, box w)
{
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    double enter = 0.0;
    double leave = 1.0;
    const auto cut = [&](double speed, double space) { // keeps the part where speed * t <= space
        if (speed == 0.0)
            return space >= 0.0;
        const double t = space / speed;
        if (speed < 0.0)
            enter = std::max(enter, t);
        else
            leave = std::min(leave, t);
        return enter <= leave;
    };
    if (!cut(-dx, a.x - w.x) || !cut(dx, w.right() - a.x) || !cut(-dy, a.y - w.y) ||
        !cut(dy, w.bottom() - a.y))
        return {};
    return segment{{a.x + enter * dx, a.y + enter * dy}, {a.x + leave * dx, a.y + leave * dy}};
}

// Returns ticks for a horizontal axis whose labels do not touch each other.
ticks horizontal_ticks(const scale& x, bool logs)
{
    const double length = std::abs(x.page_to - x.page_from);
    ticks t;
    for (std::size_t most = 11; most > 1; --most) {
        t = logs ? log_ticks(x.from, x.to, most) : nice_ticks(x.from, x.to, most);
        double widest = 0.0;
        double closest = length;
        for (std::size_t i = 0; i < t.at.size(); ++i) {
            widest = std::max(widest, text_width(t.label(t.at[i]), small_text));
            if (i > 0)
                closest = std::min(closest, (t.at[i] - t.at[i - 1]) * std::abs(x.points_per_unit()));
        }
        if (t.at.size() < 2 || closest >= widest + 7.0 || widest + 7.0 > length)
            break;
    }
    return t;
}

} // namespace

double distance(spot p, spot a, spot b) noexcept
{
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double square = dx * dx + dy * dy;
    const double t =
        square > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
    return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

std::string ticks::label(double v) const
{
    if (logs)
        return number(std::pow(10.0, v));
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

ticks log_ticks(double lo, double hi, std::size_t most)
{
    ticks t;
    t.logs = true;
    if (hi - lo < 1.0) {
        for (const double v : nice_ticks(std::pow(10.0, lo), std::pow(10.0, hi), most).at)
            t.at.push_back(std::log10(v));
        return t;
    }
    for (double decade = std::floor(lo); decade <= hi; decade += 1.0)
        for (const double factor : {1.0, 2.0, 5.0})
            if (const double v = decade + std::log10(factor); v >= lo && v <= hi)
                t.at.push_back(v);
    if (t.at.size() > most)
        std::erase_if(t.at, [](double v) { return v != std::round(v); });
    return t;
}

void draw_horizontal_axis(canvas& c, const scale& x, double y, double grid_top, const std::string& title,
                          bool logs)
{
    const group g(c, {.kind = "axis",
                      .data = {{"x0", fmt::format("{:.9g}", x(0.0))},
                               {"x-scale", fmt::format("{:.9g}", x.points_per_unit())}}});
    const ticks t = horizontal_ticks(x, logs);
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
        c.line({inside.x - tick_length, y(v)}, {inside.x, y(v)}, thin, {.kind = "tick"});
        c.text({inside.x - 4.0, y(v) + cap_height(small_text) / 2.0}, t.label(v),
               {.size = small_text, .anchor = align::end}, {.kind = "tick-label"});
    }
    c.line({inside.x, inside.y}, {inside.x, inside.bottom()}, thin);
    c.text({title_x, inside.y + inside.height / 2.0}, title,
           {.size = label_text, .anchor = align::middle, .upwards = true}, {.kind = "axis-title"});
}

std::vector<std::vector<spot>> clip(const std::vector<spot>& line, box b)
{
    std::vector<std::vector<spot>> parts;
    bool joined = false;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const auto inside = std::isfinite(line[i - 1].y) && std::isfinite(line[i].y)
                                ? clip_segment(line[i - 1], line[i], b)
                                : std::nullopt;
        if (!inside) {
            joined = false;
            continue;
        }
        if (!joined)
            parts.push_back({inside->from});
        parts.back().push_back(inside->to);
        joined = inside->to.x == line[i].x && inside->to.y == line[i].y;
    }
    return parts;
}

std::vector<spot> simplify(const std::vector<spot>& line, double tolerance)
{
    if (line.size() < 3)
        return line;
    std::vector<bool> keep(line.size(), false);
    keep.front() = keep.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, line.size() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        double worst = tolerance;
        std::size_t at = 0;
        for (std::size_t i = first + 1; i < last; ++i) {
            const double d = distance(line[i], line[first], line[last]);
            if (d > worst) {
                worst = d;
                at = i;
            }
        }
        if (at != 0) {
            keep[at] = true;
            open.emplace_back(first, at);
            open.emplace_back(at, last);
        }
    }
    std::vector<spot> out;
    for (std::size_t i = 0; i < line.size(); ++i)
        if (keep[i])
            out.push_back(line[i]);
    return out;
}

double draw_line_legend(canvas* c, const std::vector<series>& lines, double x, double y, double width)
{
    double at = x;
    double row = y;
    for (const series& s : lines) {
        const double need = sample_length + 3.0 + text_width(s.name, small_text);
        if (at > x && at + need > x + width) {
            at = x;
            row += legend_row;
        }
        if (c != nullptr) {
            const double middle = row + legend_row / 2.0;
            c->line({at, middle}, {at + sample_length, middle}, s.look, {.kind = "legend"});
            c->text({at + sample_length + 3.0, middle + cap_height(small_text) / 2.0},
                    shorten(s.name, small_text, width - sample_length - 3.0), {.size = small_text},
                    {.kind = "legend"});
        }
        at += need + 8.0;
    }
    return at > x ? row + legend_row - y : 0.0;
}

box draw_chart(canvas& c, const chart& ch)
{
    const double legend = draw_line_legend(nullptr, ch.lines, 0.0, 0.0, ch.where.width - left_column);
    const double top = legend + 3.0;
    const box inside{ch.where.x + left_column, ch.where.y + top, ch.where.width - left_column - 5.0,
                     ch.where.height - top - axis_height};
    const scale x{0.0, ch.x_to, inside.x, inside.right()};
    const scale y{0.0, ch.y_to, inside.bottom(), inside.y};
    const group g(c, {.id = ch.id,
                      .kind = "chart",
                      .data = {{"x0", fmt::format("{:.9g}", x(0.0))},
                               {"x-scale", fmt::format("{:.9g}", x.points_per_unit())},
                               {"y0", fmt::format("{:.9g}", y(0.0))},
                               {"y-scale", fmt::format("{:.9g}", y.points_per_unit())}}});
    const auto most = static_cast<std::size_t>(std::max(2.0, inside.height / 12.0));
    draw_vertical_axis(c, y, nice_ticks(y.from, y.to, most), inside, ch.y_title,
                       ch.where.x + cap_height(label_text));
    draw_horizontal_axis(c, x, inside.bottom(), inside.y, "time (s)");
    const auto on_page = [&](std::vector<spot> line) {
        for (spot& v : line)
            v = {x(v.x), y(v.y)};
        return thin_out(line);
    };
    for (const chart_band& b : ch.bands) {
        std::vector<spot> round = simplify(on_page(b.low), 0.05);
        const std::vector<spot> back = simplify(on_page(b.high), 0.05);
        round.insert(round.end(), back.rbegin(), back.rend());
        c.poly(std::move(round), true, b.look, {.kind = "band", .data = {{"name", b.name}}});
    }
    for (const series& s : ch.lines) {
        const group one(c, {.kind = "series", .data = {{"name", s.name}}});
        for (const std::vector<spot>& part : clip(on_page(s.values), inside))
            c.poly(simplify(part, 0.02), false, s.look, {.kind = "curve"});
    }
    draw_line_legend(&c, ch.lines, inside.x, ch.where.y, inside.width);
    return inside;
}

double draw_wrapped_text(canvas& c, std::string_view text, box where, std::size_t most_lines,
                         const char* kind)
{
    double y = where.y;
    for (const std::string& line : wrap(text, small_text, where.width, most_lines)) {
        c.text({where.x, y + cap_height(small_text) + 1.0}, line, {.size = small_text, .ink = dark_grey},
               {.kind = kind});
        y += note_height;
    }
    return y - where.y;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator)
{
    std::string all;
    for (const std::string& p : parts)
        if (!p.empty())
            all.append(all.empty() ? "" : separator).append(p);
    return all;
}

double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines)
{
    return draw_wrapped_text(c, join(notes, "; "), where, most_lines, "note");
}

double draw_heading(canvas& c, const std::string& title, std::string_view text, box where)
{
    constexpr double size = 8.0;
    c.text({where.x, where.y + cap_height(size)}, shorten(title, size, where.width, true),
           {.size = size, .bold = true});
    where.y += cap_height(size) + 2.5;
    return cap_height(size) + draw_wrapped_text(c, text, where, 3, "facts");
}

} // namespace tactor::plot
