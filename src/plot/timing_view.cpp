// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "plot/draw/axes.hpp"
#include "plot/draw/notes.hpp"
#include "plot/draw/stroke_starts.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/draw/timing_bars.hpp"
#include "plot/paint/text.hpp"

namespace tactor::plot {
namespace {

constexpr double strip_height = 5.0;
constexpr const char* strip_heading = "time (s)";
constexpr double dimension_pitch = 9.5;
constexpr double first_dimension = 8.0; // under the strip
constexpr double heading_height = 9.5;
constexpr double inset = 9.0;  // space before time 0, for arrows that point from outside
constexpr double outset = 7.0; // space after the last sound, for half a label
constexpr double timing_legend_height = 10.0;
constexpr std::size_t most_timing_notes = 3; // lines
constexpr double most_around_rows = 107.0;   // pt: strip, arrows, starts, axis, legend and notes

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
        starts_ = find_starts(t, frame_.x);
        frame_.top = where.y + (colours ? strip_height : 0.0) + dimensions_height() + 3.0 + starts_.height;
        const double space = where.bottom() - frame_.top - axis_gap - axis_height - timing_legend_height -
                             note_height * static_cast<double>(most_timing_notes);
        frame_.rows.fit(space);
        notes_.push_back(starts_.note);
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
        const double bottom = frame_.top + frame_.rows.all_height;
        draw_rows();
        draw_horizontal_axis(canvas_, frame_.x, bottom + axis_gap,
                             colours_ ? where_.y + strip_height : frame_.top, "time (s)");
        if (colours_)
            draw_strip();
        draw_stroke_starts(canvas_, starts_, frame_.top, bottom);
        draw_sound();
        conflicts_ = draw_conflicts(canvas_, scene_, time_, frame_);
        draw_dimensions();
        number_stroke_starts(canvas_, starts_, frame_.top);
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
            canvas_.line({frame_.x.page_from, frame_.bottom_y(i)}, {frame_.x.page_to, frame_.bottom_y(i)},
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

    void draw_sound()
    {
        const group g(canvas_, {.id = "sound"});
        if (dense_)
            draw_columns(canvas_, scene_, time_, frame_);
        else
            draw_bars(canvas_, time_, frame_);
    }

    double top_row_y(const burst& b) const
    {
        if (frame_.rows.rows.empty()) // nothing sounds
            return frame_.top;
        std::size_t row = frame_.rows.rows.size() - 1;
        for (const drive& d : b.drives)
            row = std::min(row, static_cast<std::size_t>(frame_.rows.row_by_tactor[d.tactor]));
        return frame_.top + frame_.rows.rows[row].top;
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
    stroke_starts starts_ = {};
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
