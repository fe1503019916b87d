// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

constexpr double strip_height = 5.0;
constexpr const char* strip_heading = "time (s)";
constexpr double dimension_pitch = 9.5;
constexpr double first_dimension = 8.0; // under the strip
constexpr double heading_height = 9.5;
constexpr double inset = 3.0;  // space before time 0
constexpr double outset = 7.0; // space after the last sound, for half a label
constexpr double timing_legend_height = 10.0;
constexpr std::size_t most_timing_notes = 3; // lines
constexpr double most_around_rows = 107.0;   // pt: strip, dimensions, starts, axis, legend and notes

// Places of the rows of the timing diagram.
struct timing_frame {
    lanes rows = {};
    scale x = {};
    double top = 0.0;  ///< of the first row, pt
    double peak = 1.0; ///< largest amplitude

    /// Level of each stroke in each row; empty: all have the same.
    std::vector<std::size_t> levels = {};

    double base_y(std::size_t row, std::size_t stroke) const noexcept
    {
        const std::size_t level = levels.empty() ? 0 : levels[stroke];
        return top + rows.top(row) + static_cast<double>(level + 1) * rows.height;
    }
    double bar_height(double amplitude) const noexcept { return 0.86 * rows.height * amplitude / peak; }
};

constexpr std::size_t most_bars = 2500;
constexpr double narrowest_bar = 0.9; // pt
constexpr std::size_t most_hatches = 200;
constexpr double seen_through = 0.7;

std::size_t find_row(const timing_frame& f, unsigned tactor)
{
    return static_cast<std::size_t>(f.rows.row_by_tactor[tactor]);
}

// Returns true if bars of one row overlap: only then must one show through the other.
bool rows_overlap(const timeline& t, const timing_frame& f)
{
    // Strokes that could lie on each other have levels of their own.
    const std::size_t strokes = f.levels.empty() ? 1 : t.starts_s.size();
    std::vector<double> ends(f.rows.rows.size() * strokes, -1.0);
    for (const shown_burst& b : t.bursts)
        for (const drive& d : b.what->drives) {
            double& end = ends[find_row(f, d.tactor) * strokes + (strokes == 1 ? 0 : b.stroke)];
            if (b.from_s < end - 1e-9)
                return true;
            end = std::max(end, b.to_s);
        }
    return false;
}

// Calls note(burst, time) for instants of a continuous plan, two for each column of the page.
template <class Note>
void sample_curve(const plan& p, const scale& x, Note&& note)
{
    const double columns = p.stroke_duration_s * x.per_unit() / column_width;
    const auto n = static_cast<std::size_t>(std::clamp(columns * 2.0, 1.0, 20000.0));
    burst b;
    for (std::size_t k = 0; k < n; ++k) {
        const double at = p.stroke_duration_s * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
        p.curve->at(at, b);
        note(b, at);
    }
}

// Gives simultaneous strokes separate levels in the rows, one below the other, if `space` pt are enough.
// Returns a note if they are not; else empty.
std::string part_strokes(timing_frame& f, const timeline& t, double space)
{
    if (!t.several())
        return {};
    std::vector<std::size_t> order(t.starts_s.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return t.starts_s[a] < t.starts_s[b]; });
    f.levels.resize(order.size());
    std::vector<double> ends; // by level
    for (const std::size_t i : order) {
        const auto free =
            std::find_if(ends.begin(), ends.end(), [&](double end) { return end <= t.starts_s[i] + 1e-9; });
        f.levels[i] = static_cast<std::size_t>(free - ends.begin());
        if (free == ends.end())
            ends.push_back(t.ends_s[i]);
        else
            *free = t.ends_s[i];
    }
    f.rows.levels = ends.size();
    if (f.rows.fit(space))
        return {};
    // The page would be too long: strokes lie on each other, and show through.
    f.levels.clear();
    f.rows.levels = 1;
    f.rows.fit(space);
    return "strokes on one tactor lie on each other";
}

// Returns true if there are too many bars, or too narrow ones, to draw each.
bool too_dense(const timeline& t, const timing_frame& f)
{
    std::size_t bars = 0;
    std::size_t narrow = 0;
    for (const shown_burst& b : t.bursts) {
        bars += b.what->drives.size();
        narrow += (b.to_s - b.from_s) * f.x.per_unit() < narrowest_bar ? 1 : 0;
    }
    return t.sampled || bars > most_bars || 2 * narrow > t.bursts.size() ||
           f.rows.rows.size() < t.playing.size();
}

// Draws a bar for each tactor of each burst; bars are translucent if some overlap in a row.
void draw_bars(canvas& c, const timeline& t, const timing_frame& f)
{
    const group all(c, {.id = "sound"});
    const double alpha = rows_overlap(t, f) ? seen_through : 1.0;
    for (const shown_burst& b : t.bursts) {
        const colour fill = with_alpha(burst_colour(t, b), alpha);
        for (const drive& d : b.what->drives) {
            const double h = f.bar_height(d.amplitude);
            c.rect({f.x(b.from_s), f.base_y(find_row(f, d.tactor), b.stroke) - h,
                    (b.to_s - b.from_s) * f.x.per_unit(), h},
                   {.fill = fill, .stroke = ink, .width = 0.3},
                   {.kind = "bar",
                    .data = {{"burst", fmt::format("{}", b.number)},
                             {"tactor", fmt::format("{}", d.tactor)},
                             {"stroke", fmt::format("{}", b.stroke)}}});
        }
    }
}

// Draws the largest amplitude of each row over time: for `continuous`, and for too many bars.
void draw_columns(canvas& c, const scene& s, const timeline& t, const timing_frame& f)
{
    const group all(c, {.id = "sound"});
    // Draws each stroke separately if it has a colour; else all together.
    const bool by_stroke = !f.levels.empty();
    const double count = std::ceil((f.x.page_to - f.x.page_from) / column_width);
    const scale columns{0.0, count, f.x.page_from, f.x.page_from + count * column_width};
    const std::vector<column_range> silent(static_cast<std::size_t>(count) + 1);
    std::vector<std::vector<std::vector<column_range>>> profiles(
        by_stroke ? s.plans.size() : 1, std::vector<std::vector<column_range>>(f.rows.rows.size(), silent));
    const auto column_at = [&](double t_s) {
        return static_cast<std::size_t>(std::clamp((f.x(t_s) - f.x.page_from) / column_width, 0.0, count));
    };
    const auto note = [&](std::size_t stroke, const burst& b, double from_s, double to_s) {
        for (const drive& d : b.drives) {
            if (f.rows.row_by_tactor[d.tactor] < 0)
                continue;
            std::vector<column_range>& row = profiles[by_stroke ? stroke : 0][find_row(f, d.tactor)];
            for (std::size_t i = column_at(from_s); i <= column_at(to_s); ++i)
                row[i].high = std::max(row[i].high, static_cast<float>(d.amplitude));
        }
    };
    for (const shown_burst& b : t.bursts)
        if (b.to_s > b.from_s)
            note(b.stroke, *b.what, b.from_s, b.to_s);
    for (std::size_t i = 0; i < s.plans.size(); ++i)
        if (const plan& p = s.plans[i].plan; p.curve)
            sample_curve(p, f.x, [&](const burst& b, double at) {
                note(i, b, t.starts_s[i] + at, t.starts_s[i] + at);
            });
    style look = t.sampled ? style{.fill = grey, .stroke = ink, .width = 0.5}
                           : style{.fill = dark_grey, .stroke = ink, .width = 0.1};
    for (std::size_t stroke = 0; stroke < profiles.size(); ++stroke) {
        if (by_stroke)
            look.fill = stroke_colour(t.looks[stroke]);
        for (std::size_t i = 0; i < f.rows.rows.size(); ++i) {
            const double base = f.base_y(i, stroke);
            for (std::vector<spot>& shape :
                 outline(profiles[stroke][i], columns, {0.0, 1.0, base, base - f.bar_height(1.0)}))
                c.poly(std::move(shape), true, look,
                       {.kind = "envelope", .data = {{"row", fmt::format("{}", i)}}});
        }
    }
}

// Draws slanted lines inside a box, and its rim.
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

// Hatches the times in which one tactor serves two bursts. Returns true if there are any.
bool draw_conflicts(canvas& c, const scene& s, const timeline& t, const timing_frame& f)
{
    const group g(c, {.id = "conflicts"});
    std::size_t drawn = 0;
    const double h = f.bar_height(f.peak);
    for (std::size_t i = 0; i < s.plans.size(); ++i)
        for (const conflict& k : s.plans[i].plan.conflicts) {
            if (f.rows.row_by_tactor[k.tactor] < 0 || drawn == most_hatches)
                continue;
            ++drawn;
            draw_hatch(c,
                       {f.x(t.starts_s[i] + k.from_s), f.base_y(find_row(f, k.tactor), i) - h,
                        (k.to_s - k.from_s) * f.x.per_unit(), h},
                       {.kind = "conflict", .data = {{"tactor", fmt::format("{}", k.tactor)}}});
        }
    return drawn != 0;
}

// Draws a line with ends from x0 to x1 at y, and its label in it or to its right. Thin lines run down to
// `below` at both ends.
void draw_dimension(canvas& c, double x0, double x1, double y, double below, const std::string& label,
                    const mark& m)
{
    const group g(c, m);
    const style thin{.stroke = ink, .width = 0.45};
    for (const double x : {x0, x1}) {
        c.line({x, y - 3.0}, {x, below}, {.stroke = dark_grey, .width = 0.35, .dash = 1.0});
        c.line({x, y - 1.5}, {x, y + 1.5}, thin);
    }
    const double width = text_width(label, small_text);
    const bool inside = x1 - x0 >= width + 12.0;
    const double left = inside ? (x0 + x1 - width) / 2.0 : x1 + 2.5;
    c.line({x0, y}, {inside ? left - 2.0 : x1, y}, thin);
    if (inside)
        c.line({left + width + 2.0, y}, {x1, y}, thin);
    c.text({left, y + cap_height(small_text) / 2.0}, label, {.size = small_text, .halo = true});
}

class timing_drawing {
public:
    timing_drawing(canvas& c, const scene& s, const timeline& t, box where, bool colours)
        : canvas_(c),
          scene_(s),
          time_(t),
          where_(where),
          colours_(colours),
          frame_{make_lanes(s.tactors, t.playing, where.height - most_around_rows), {}, 0.0, t.peak, {}}
    {
        if (colours)
            frame_.rows.label_width =
                std::max(frame_.rows.label_width, text_width(strip_heading, small_text));
        const double left = where.x + frame_.rows.label_width + 4.0;
        const double per_s = (where.right() - left - inset - outset) / std::max(t.total_s, 1e-9);
        frame_.x = {-inset / per_s, t.total_s + outset / per_s, left, where.right()};
        find_first_pair();
        frame_.top = where.y + (colours ? strip_height : 0.0) + dimensions_height() + 3.0 + starts_height(t);
        const double space = where.bottom() - frame_.top - axis_gap - axis_height - timing_legend_height -
                             note_height * static_cast<double>(most_timing_notes);
        frame_.rows.fit(space);
        notes_.push_back(part_strokes(frame_, t, space));
        dense_ = too_dense(t, frame_);
    }

    double draw()
    {
        const group all(canvas_, {.id = "timing",
                                  .data = {{"x0", fmt::format("{:.9g}", frame_.x(0.0))},
                                           {"x-scale", fmt::format("{:.9g}", frame_.x.per_unit())},
                                           {"top", fmt::format("{:.9g}", frame_.top)},
                                           {"row-height", fmt::format("{:.9g}", frame_.rows.height)},
                                           {"bar-height", fmt::format("{:.9g}", frame_.bar_height(1.0))},
                                           {"drawn", dense_ ? "columns" : "bars"}}});
        const double bottom = frame_.top + frame_.rows.all_height();
        draw_rows();
        draw_horizontal_axis(canvas_, frame_.x, bottom + axis_gap,
                             colours_ ? where_.y + strip_height : frame_.top, "time (s)");
        if (colours_)
            draw_strip();
        if (dense_)
            draw_columns(canvas_, scene_, time_, frame_);
        else
            draw_bars(canvas_, time_, frame_);
        conflicts_ = draw_conflicts(canvas_, scene_, time_, frame_);
        draw_dimensions();
        notes_.push_back(draw_stroke_starts(canvas_, time_, frame_.x, frame_.top, bottom));
        const double legend_y = bottom + axis_gap + axis_height + timing_legend_height / 2.0;
        draw_legend(legend_y);
        const double end = legend_y + timing_legend_height / 2.0;
        return end - where_.y +
               draw_notes(canvas_, notes_, {where_.x, end, where_.width, 0.0}, most_timing_notes);
    }

private:
    // Finds the first two bursts of the first stroke that has two, or the first burst.
    void find_first_pair()
    {
        if (time_.sampled || time_.bursts.empty())
            return;
        first_ = &time_.bursts[0];
        for (std::size_t i = 1; i < time_.bursts.size() && second_ == nullptr; ++i)
            if (time_.bursts[i].stroke == time_.bursts[i - 1].stroke) {
                first_ = &time_.bursts[i - 1];
                second_ = &time_.bursts[i];
            }
    }

    double dimensions_height() const
    {
        const int n = (first_ != nullptr ? 1 : 0) + (second_ != nullptr ? 1 : 0);
        return n == 0 ? heading_height : first_dimension + n * dimension_pitch - 4.0;
    }

    void draw_rows()
    {
        for (std::size_t i = 0; i < frame_.rows.rows.size(); ++i)
            canvas_.line({frame_.x.page_from, frame_.top + frame_.rows.top(i + 1)},
                         {frame_.x.page_to, frame_.top + frame_.rows.top(i + 1)},
                         {.stroke = light_grey, .width = 0.4}, {.kind = "row-line"});
        notes_.push_back(draw_lane_labels(canvas_, frame_.rows, frame_.x.page_from - 3.0, frame_.top));
        canvas_.text({frame_.x.page_from - 3.0, frame_.top - 3.5}, frame_.rows.heading,
                     {.size = small_text, .anchor = align::end, .ink = dark_grey}, {.kind = "row-heading"});
    }

    void draw_strip()
    {
        canvas_.text({frame_.x.page_from - 3.0, where_.y + (strip_height + cap_height(small_text)) / 2.0},
                     strip_heading, {.size = small_text, .anchor = align::end, .ink = dark_grey},
                     {.kind = "row-heading"});
        draw_time_strip(canvas_,
                        {frame_.x(0.0), where_.y, frame_.x(time_.total_s) - frame_.x(0.0), strip_height});
    }

    double top_row_y(const burst& b) const
    {
        std::size_t row = frame_.rows.rows.size();
        for (const drive& d : b.drives)
            row = std::min(row, static_cast<std::size_t>(frame_.rows.row_by_tactor[d.tactor]));
        return frame_.top + frame_.rows.top(row);
    }

    void draw_dimensions()
    {
        if (first_ == nullptr)
            return;
        const std::string which = common_soa() ? "" : "first ";
        double y = where_.y + (colours_ ? strip_height : 0.0) + first_dimension;
        if (second_ != nullptr) {
            draw_dimension(canvas_, frame_.x(first_->from_s), frame_.x(second_->from_s), y,
                           std::max(top_row_y(*first_->what), top_row_y(*second_->what)),
                           fmt::format("{}SOA {}", which, seconds_text(second_->from_s - first_->from_s, 4)),
                           {.id = "soa"});
            y += dimension_pitch;
        }
        draw_dimension(canvas_, frame_.x(first_->from_s), frame_.x(first_->to_s), y, top_row_y(*first_->what),
                       fmt::format("{}duration {}", which, seconds_text(first_->to_s - first_->from_s, 4)),
                       {.id = "duration"});
    }

    bool common_soa() const
    {
        return std::all_of(scene_.plans.begin(), scene_.plans.end(), [&](const placed_plan& p) {
            return p.plan.soa_s && *p.plan.soa_s == scene_.plans[0].plan.soa_s;
        });
    }

    void draw_legend(double y)
    {
        const group g(canvas_, {.id = "timing-legend"});
        const double baseline = y + cap_height(small_text) / 2.0;
        double x = where_.x;
        const auto word = [&](const std::string& text, double gap) {
            canvas_.text({x, baseline}, text, {.size = small_text});
            x += text_width(text, small_text) + gap;
        };
        word("amplitude", 5.0);
        for (const double part : {0.25, 0.5, 1.0}) {
            const double h = frame_.bar_height(part * time_.peak);
            canvas_.rect({x, y + 4.0 - h, 5.0, h},
                         {.fill = dense_ ? grey : light_grey, .stroke = ink, .width = 0.3});
            x += 7.0;
            word(number(part * time_.peak, 3), 6.0);
        }
        x += 4.0;
        if (!conflicts_)
            return;
        draw_hatch(canvas_, {x, y - 3.5, 10.0, 7.0}, {.kind = "legend"});
        canvas_.text({x + 12.5, baseline}, "two bursts on one tactor", {.size = small_text});
    }

    canvas& canvas_;
    const scene& scene_;
    const timeline& time_;
    box where_;
    bool colours_;
    timing_frame frame_;
    std::vector<std::string> notes_ = {};
    bool dense_ = false;
    bool conflicts_ = false;
    const shown_burst* first_ = nullptr;
    const shown_burst* second_ = nullptr;
};

} // namespace

double draw_timing_view(canvas& c, const scene& s, const timeline& t, box where, bool colours)
{
    return timing_drawing(c, s, t, where, colours).draw();
}

} // namespace tactor::plot
