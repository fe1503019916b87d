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
constexpr double first_dimension = 8.0; // distance below the strip
constexpr double heading_height = 9.5;
constexpr double inset = 3.0;  // space to the left of time 0
constexpr double outset = 7.0; // space after the last sound, for half of a label
constexpr double timing_legend_height = 10.0;
constexpr std::size_t most_timing_notes = 3; // number of lines
constexpr double most_around_rows = 107.0;   // pt: strip, dimensions, starts, axis, legend and notes

constexpr std::size_t most_bars = 2500;
constexpr double narrowest_bar = 0.9; // pt
constexpr std::size_t most_hatches = 200;
constexpr double seen_through = 0.7;

// Calls note(burst, time) at regular times of a continuous plan, twice for each column of the page.
template <class Note>
void sample_curve(const plan& p, const scale& x, Note&& note)
{
    const double columns = p.stroke_duration_s * x.points_per_unit() / column_width;
    const auto n = static_cast<std::size_t>(std::clamp(columns * 2.0, 1.0, 20000.0));
    burst b;
    for (std::size_t k = 0; k < n; ++k) {
        const double at = p.stroke_duration_s * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
        p.curve->at(at, b);
        note(b, at);
    }
}

// Draws a rectangle with slanted lines inside.
void draw_hatch(canvas& c, box b, const mark& m)
{
    const group g(c, m);
    const style thin{.stroke = black, .width = 0.4};
    constexpr double apart = 2.4;
    // The lines x + y = k are the same on the whole page, so that they continue in the next box.
    const double first = std::ceil((b.x + b.y) / apart) * apart;
    for (double k = first; k < b.right() + b.bottom(); k += apart) {
        const double x_top = std::min(b.right(), k - b.y);
        const double x_bottom = std::max(b.x, k - b.bottom());
        c.line({x_bottom, k - x_bottom}, {x_top, k - x_top}, thin);
    }
    c.rect(b, {.stroke = black, .width = 0.5}, {.kind = "rim"});
}

// Draws a horizontal line from x0 to x1 at y with marks at its ends. Its label is on the line or to
// the right of it. Thin lines run from both ends down to `below`.
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
          rows_(make_lanes(s.tactors, t.playing, where.height - most_around_rows))
    {
        if (colours)
            rows_.label_width = std::max(rows_.label_width, text_width(strip_heading, small_text));
        const double left = where.x + rows_.label_width + 4.0;
        const double per_s = (where.right() - left - inset - outset) / std::max(t.total_s, 1e-9);
        x_ = {-inset / per_s, t.total_s + outset / per_s, left, where.right()};
        find_first_pair();
        top_ = where.y + (colours ? strip_height : 0.0) + dimensions_height() + 3.0 + starts_height(t);
        const double space = where.bottom() - top_ - axis_gap - axis_height - timing_legend_height -
                             note_height * static_cast<double>(most_timing_notes);
        rows_.fit(space);
        separate_strokes(space);
        dense_ = is_too_dense();
    }

    double draw()
    {
        const group all(canvas_, {.id = "timing",
                                  .data = {{"x0", fmt::format("{:.9g}", x_(0.0))},
                                           {"x-scale", fmt::format("{:.9g}", x_.points_per_unit())},
                                           {"top", fmt::format("{:.9g}", top_)},
                                           {"row-height", fmt::format("{:.9g}", rows_.height)},
                                           {"bar-height", fmt::format("{:.9g}", bar_height(1.0))},
                                           {"drawn", dense_ ? "columns" : "bars"}}});
        const double bottom = top_ + rows_.total_height();
        draw_rows();
        draw_horizontal_axis(canvas_, x_, bottom + axis_gap, colours_ ? where_.y + strip_height : top_,
                             "time (s)");
        if (colours_)
            draw_strip();
        if (dense_)
            draw_columns();
        else
            draw_bars();
        conflicts_ = draw_conflicts();
        draw_dimensions();
        notes_.push_back(draw_stroke_starts(canvas_, time_, x_, top_, bottom));
        const double legend_y = bottom + axis_gap + axis_height + timing_legend_height / 2.0;
        draw_legend(legend_y);
        const double end = legend_y + timing_legend_height / 2.0;
        return end - where_.y +
               draw_notes(canvas_, notes_, {where_.x, end, where_.width, 0.0}, most_timing_notes);
    }

private:
    double base_y(std::size_t row, std::size_t stroke) const
    {
        const std::size_t level = levels_.empty() ? 0 : levels_[stroke];
        return top_ + rows_.top(row) + static_cast<double>(level + 1) * rows_.height;
    }

    double bar_height(double amplitude) const { return 0.86 * rows_.height * amplitude / time_.peak; }

    std::size_t find_row(unsigned tactor) const
    {
        return static_cast<std::size_t>(rows_.row_by_tactor[tactor]);
    }

    // Gives simultaneous strokes separate levels, one below the other, in each row. If `space` pt are not
    // enough, adds a note instead.
    void separate_strokes(double space)
    {
        if (!time_.has_several_strokes())
            return;
        std::vector<std::size_t> order(time_.starts_s.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return time_.starts_s[a] < time_.starts_s[b]; });
        levels_.resize(order.size());
        std::vector<double> ends; // end of the last burst on each level
        for (const std::size_t i : order) {
            const auto free = std::find_if(ends.begin(), ends.end(),
                                           [&](double end) { return end <= time_.starts_s[i] + 1e-9; });
            levels_[i] = static_cast<std::size_t>(free - ends.begin());
            if (free == ends.end())
                ends.push_back(time_.ends_s[i]);
            else
                *free = time_.ends_s[i];
        }
        rows_.levels = ends.size();
        if (rows_.fit(space))
            return;
        // The page would be too long. Draw strokes over each other, translucently.
        levels_.clear();
        rows_.levels = 1;
        rows_.fit(space);
        notes_.push_back("strokes on one tactor overlap");
    }

    // Returns true if there are too many bars to draw each of them, or if too many are too narrow.
    bool is_too_dense() const
    {
        std::size_t bars = 0;
        std::size_t narrow = 0;
        for (const shown_burst& b : time_.bursts) {
            bars += b.what->drives.size();
            narrow += (b.to_s - b.from_s) * x_.points_per_unit() < narrowest_bar ? 1 : 0;
        }
        return time_.sampled || bars > most_bars || 2 * narrow > time_.bursts.size() ||
               rows_.rows.size() < time_.playing.size();
    }

    // Returns true if bars in a row overlap. Only then are bars drawn translucently.
    bool has_overlapping_bars() const
    {
        // If strokes have separate levels, only bars of the same stroke can overlap.
        const std::size_t strokes = levels_.empty() ? 1 : time_.starts_s.size();
        std::vector<double> ends(rows_.rows.size() * strokes, -1.0);
        for (const shown_burst& b : time_.bursts)
            for (const drive& d : b.what->drives) {
                double& end = ends[find_row(d.tactor) * strokes + (strokes == 1 ? 0 : b.stroke)];
                if (b.from_s < end - 1e-9)
                    return true;
                end = std::max(end, b.to_s);
            }
        return false;
    }

    // Draws a bar for each tactor of each burst. Bars are translucent if some of them overlap in a row.
    void draw_bars()
    {
        const group all(canvas_, {.id = "sound"});
        const double alpha = has_overlapping_bars() ? seen_through : 1.0;
        for (const shown_burst& b : time_.bursts) {
            const colour fill = with_alpha(burst_colour(time_, b), alpha);
            for (const drive& d : b.what->drives) {
                const double h = bar_height(d.amplitude);
                canvas_.rect({x_(b.from_s), base_y(find_row(d.tactor), b.stroke) - h,
                              (b.to_s - b.from_s) * x_.points_per_unit(), h},
                             {.fill = fill, .stroke = ink, .width = 0.3},
                             {.kind = "bar",
                              .data = {{"burst", fmt::format("{}", b.number)},
                                       {"tactor", fmt::format("{}", d.tactor)},
                                       {"stroke", fmt::format("{}", b.stroke)}}});
            }
        }
    }

    // Draws the greatest amplitude in each row over time. Used for the algorithm `continuous`, and if there
    // are too many bars.
    void draw_columns()
    {
        const group all(canvas_, {.id = "sound"});
        // If strokes have separate levels, each stroke has its own colour and is drawn separately. Otherwise
        // all strokes are drawn together.
        const bool by_stroke = !levels_.empty();
        const double count = std::ceil((x_.page_to - x_.page_from) / column_width);
        const scale columns{0.0, count, x_.page_from, x_.page_from + count * column_width};
        const std::vector<column_range> silent(static_cast<std::size_t>(count) + 1);
        std::vector<std::vector<std::vector<column_range>>> profiles(
            by_stroke ? scene_.plans.size() : 1,
            std::vector<std::vector<column_range>>(rows_.rows.size(), silent));
        const auto column_at = [&](double t_s) {
            return static_cast<std::size_t>(std::clamp((x_(t_s) - x_.page_from) / column_width, 0.0, count));
        };
        const auto note = [&](std::size_t stroke, const burst& b, double from_s, double to_s) {
            for (const drive& d : b.drives) {
                if (rows_.row_by_tactor[d.tactor] < 0)
                    continue;
                std::vector<column_range>& row = profiles[by_stroke ? stroke : 0][find_row(d.tactor)];
                for (std::size_t i = column_at(from_s); i <= column_at(to_s); ++i)
                    row[i].high = std::max(row[i].high, static_cast<float>(d.amplitude));
            }
        };
        for (const shown_burst& b : time_.bursts)
            if (b.to_s > b.from_s)
                note(b.stroke, *b.what, b.from_s, b.to_s);
        for (std::size_t i = 0; i < scene_.plans.size(); ++i)
            if (const plan& p = scene_.plans[i].plan; p.curve)
                sample_curve(p, x_, [&](const burst& b, double at) {
                    note(i, b, time_.starts_s[i] + at, time_.starts_s[i] + at);
                });
        style look = time_.sampled ? style{.fill = grey, .stroke = ink, .width = 0.5}
                                   : style{.fill = dark_grey, .stroke = ink, .width = 0.1};
        for (std::size_t stroke = 0; stroke < profiles.size(); ++stroke) {
            if (by_stroke)
                look.fill = stroke_colour(time_.looks[stroke]);
            for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
                const double base = base_y(i, stroke);
                for (std::vector<spot>& shape :
                     outline(profiles[stroke][i], columns, {0.0, 1.0, base, base - bar_height(1.0)}))
                    canvas_.poly(std::move(shape), true, look,
                                 {.kind = "envelope", .data = {{"row", fmt::format("{}", i)}}});
            }
        }
    }

    // Draws hatching at times at which a tactor plays for two bursts. Returns true if there are such times.
    bool draw_conflicts()
    {
        const group g(canvas_, {.id = "conflicts"});
        std::size_t drawn = 0;
        const double h = bar_height(time_.peak);
        for (std::size_t i = 0; i < scene_.plans.size(); ++i)
            for (const conflict& k : scene_.plans[i].plan.conflicts) {
                if (rows_.row_by_tactor[k.tactor] < 0 || drawn == most_hatches)
                    continue;
                ++drawn;
                draw_hatch(canvas_,
                           {x_(time_.starts_s[i] + k.from_s), base_y(find_row(k.tactor), i) - h,
                            (k.to_s - k.from_s) * x_.points_per_unit(), h},
                           {.kind = "conflict", .data = {{"tactor", fmt::format("{}", k.tactor)}}});
            }
        return drawn != 0;
    }

    // Finds the first two bursts of the first stroke that has at least two. If there is no such stroke, finds
    // the first burst.
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
        for (std::size_t i = 0; i < rows_.rows.size(); ++i)
            canvas_.line({x_.page_from, top_ + rows_.top(i + 1)}, {x_.page_to, top_ + rows_.top(i + 1)},
                         {.stroke = light_grey, .width = 0.4}, {.kind = "row-line"});
        notes_.push_back(draw_lane_labels(canvas_, rows_, x_.page_from - 3.0, top_));
        canvas_.text({x_.page_from - 3.0, top_ - 3.5}, rows_.heading,
                     {.size = small_text, .anchor = align::end, .ink = dark_grey}, {.kind = "row-heading"});
    }

    void draw_strip()
    {
        canvas_.text({x_.page_from - 3.0, where_.y + (strip_height + cap_height(small_text)) / 2.0},
                     strip_heading, {.size = small_text, .anchor = align::end, .ink = dark_grey},
                     {.kind = "row-heading"});
        draw_time_strip(canvas_, {x_(0.0), where_.y, x_(time_.total_s) - x_(0.0), strip_height});
    }

    double top_row_y(const burst& b) const
    {
        std::size_t row = rows_.rows.size();
        for (const drive& d : b.drives)
            row = std::min(row, find_row(d.tactor));
        return top_ + rows_.top(row);
    }

    void draw_dimensions()
    {
        if (first_ == nullptr)
            return;
        const std::string which = has_common_soa() ? "" : "first ";
        double y = where_.y + (colours_ ? strip_height : 0.0) + first_dimension;
        if (second_ != nullptr) {
            draw_dimension(canvas_, x_(first_->from_s), x_(second_->from_s), y,
                           std::max(top_row_y(*first_->what), top_row_y(*second_->what)),
                           fmt::format("{}SOA {}", which, seconds_text(second_->from_s - first_->from_s, 4)),
                           {.id = "soa"});
            y += dimension_pitch;
        }
        draw_dimension(canvas_, x_(first_->from_s), x_(first_->to_s), y, top_row_y(*first_->what),
                       fmt::format("{}duration {}", which, seconds_text(first_->to_s - first_->from_s, 4)),
                       {.id = "duration"});
    }

    bool has_common_soa() const
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
            const double h = bar_height(part * time_.peak);
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
    lanes rows_;
    scale x_ = {};
    double top_ = 0.0;                     // top of the first row, pt
    std::vector<std::size_t> levels_ = {}; // level of each stroke in a row; empty if all share one
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
