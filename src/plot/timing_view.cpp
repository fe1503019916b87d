// SPDX-License-Identifier: MIT
#include "plot/timing_view.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "plot/array_view.hpp"
#include "plot/axes.hpp"
#include "plot/dimensions.hpp"
#include "plot/lanes.hpp"
#include "plot/text.hpp"

namespace tactor::plot {
namespace {

constexpr double strip_height = 5.0;
constexpr double dimension_pitch = 9.5;
constexpr double first_dimension = 8.0; // under the strip
constexpr double heading_height = 7.0;
constexpr double inset = 9.0;         // of time 0 in the diagram: room for arrows that point from outside
constexpr double outset = 7.0;        // behind the last sound: room for half a label
constexpr double starts_height = 7.0; // for the numbers of strokes
constexpr double full_bar = 0.86;     // of a row's height
constexpr std::size_t most_starts = 200;
constexpr std::size_t most_bars = 2500;
constexpr double narrowest_bar = 0.9; // pt
constexpr std::size_t most_hatches = 200;
constexpr double legend_height = 10.0;

class view {
public:
    view(canvas& c, const scene& s, const timeline& t, box where, bool colours)
        : canvas_(c),
          scene_(s),
          time_(t),
          where_(where),
          colours_(colours),
          lanes_(make_lanes(s.tactors, t.playing))
    {
        const double left = where.x + lanes_.label_width + 4.0;
        const double per_s = (where.right() - left - inset - outset) / std::max(t.total_s, 1e-9);
        x_ = {-inset / per_s, t.total_s + outset / per_s, left, where.right()};
        find_first_pair();
        top_ = where.y + (colours ? strip_height : 0.0) + dimensions_height() + 3.0 +
               (t.starts_s.size() > 1 ? starts_height : 0.0);
        dense_ = too_dense();
    }

    double draw()
    {
        const group all(canvas_, {.id = "timing",
                                  .data = {{"x0", fmt::format("{:.9g}", x_(0.0))},
                                           {"x-scale", fmt::format("{:.9g}", x_.per_unit())},
                                           {"row-height", fmt::format("{:.9g}", lanes_.height)},
                                           {"bar-height", fmt::format("{:.9g}", bar_height(1.0))},
                                           {"drawn", dense_ ? "columns" : "bars"}}});
        const double bottom = top_ + lanes_.all_height();
        draw_rows();
        draw_horizontal_axis(canvas_, x_, bottom + 1.5, colours_ ? where_.y + strip_height : top_,
                             "time (s)");
        if (colours_)
            draw_strip();
        draw_stroke_starts(bottom);
        draw_sound();
        draw_conflicts();
        draw_dimensions();
        const double legend_y = bottom + 1.5 + axis_height + legend_height / 2.0;
        draw_legend(legend_y);
        return legend_y + legend_height / 2.0 - where_.y;
    }

private:
    double base_of(std::size_t row) const { return top_ + static_cast<double>(row + 1) * lanes_.height; }
    double bar_height(double amplitude) const { return full_bar * lanes_.height * amplitude / time_.peak; }

    // The first two bursts of the first stroke that has two, or the first burst.
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

    bool too_dense() const
    {
        std::size_t bars = 0;
        double narrow = 0.0;
        for (const shown_burst& b : time_.bursts) {
            bars += b.what->drives.size();
            narrow += (b.to_s - b.from_s) * x_.per_unit() < narrowest_bar ? 1.0 : 0.0;
        }
        return time_.sampled || bars > most_bars || narrow > 0.5 * static_cast<double>(time_.bursts.size()) ||
               lanes_.rows.size() < time_.playing.size();
    }

    void draw_rows()
    {
        for (std::size_t i = 0; i < lanes_.rows.size(); ++i)
            canvas_.line({x_.page_from, base_of(i)}, {x_.page_to, base_of(i)},
                         {.stroke = light_grey, .width = 0.4}, {.kind = "row-line"});
        draw_lane_labels(canvas_, lanes_, x_.page_from - 3.0, top_);
        canvas_.text({x_.page_from - 3.0, top_ - 3.5}, lane_heading,
                     {.size = small_text, .anchor = align::end, .ink = dark_grey}, {.kind = "row-heading"});
    }

    void draw_strip()
    {
        canvas_.text({x_.page_from - 3.0, where_.y + (strip_height + cap_height(small_text)) / 2.0}, "colour",
                     {.size = small_text, .anchor = align::end, .ink = dark_grey}, {.kind = "row-heading"});
        draw_time_strip(canvas_, time_, {x_(0.0), where_.y, x_(time_.total_s) - x_(0.0), strip_height});
    }

    // A line at each start with the numbers of the strokes that start there.
    void draw_stroke_starts(double bottom)
    {
        if (time_.starts_s.size() < 2)
            return;
        const group g(canvas_, {.id = "stroke-starts"});
        std::map<double, std::string> numbers;
        for (std::size_t i = 0; i < std::min(time_.starts_s.size(), most_starts); ++i) {
            std::string& s = numbers[std::round(x_(time_.starts_s[i]) * 10.0) / 10.0];
            s += (s.empty() ? "" : ", ") + fmt::format("{}", i + 1);
        }
        std::string word = "stroke "; // for the first
        double free = 0.0;
        for (auto i = numbers.begin(); i != numbers.end(); ++i) {
            const double x = i->first;
            const double next = std::next(i) != numbers.end() ? std::next(i)->first : where_.right();
            canvas_.line({x, top_ - 8.0}, {x, bottom}, {.stroke = dark_grey, .width = 0.5, .dash = 2.0},
                         {.kind = "stroke-start"});
            const std::string label =
                x + 2.0 + text_width(word + i->second, small_text) < next ? word + i->second : i->second;
            word.clear();
            if (x < free)
                continue;
            canvas_.text({x + 2.0, top_ - 3.0}, label, {.size = small_text, .ink = dark_grey, .halo = true});
            free = x + 3.0 + text_width(label, small_text);
        }
    }

    void draw_sound()
    {
        const group g(canvas_, {.id = "sound"});
        if (dense_)
            draw_columns();
        else
            draw_bars();
    }

    void draw_bars()
    {
        const bool overlaps = rows_overlap();
        for (const shown_burst& b : time_.bursts) {
            const colour fill = time_colour(time_, b.target_s);
            for (const drive& d : b.what->drives) {
                const double base = base_of(static_cast<std::size_t>(lanes_.row_of[d.tactor]));
                const double h = bar_height(d.amplitude);
                canvas_.rect({x_(b.from_s), base - h, (b.to_s - b.from_s) * x_.per_unit(), h},
                             {.fill = overlaps ? with_alpha(fill, 0.7) : fill, .stroke = ink, .width = 0.3},
                             {.kind = "bar",
                              .data = {{"burst", fmt::format("{}", b.number)},
                                       {"tactor", fmt::format("{}", d.tactor)}}});
            }
        }
    }

    // Whether bars of one row overlap: only then must one show through the other.
    bool rows_overlap() const
    {
        std::vector<double> ends(lanes_.rows.size(), -1.0);
        for (const shown_burst& b : time_.bursts)
            for (const drive& d : b.what->drives) {
                double& end = ends[static_cast<std::size_t>(lanes_.row_of[d.tactor])];
                if (b.from_s < end - 1e-9)
                    return true;
                end = std::max(end, b.to_s);
            }
        return false;
    }

    void draw_columns()
    {
        std::vector<column_profile> profiles(lanes_.rows.size(), column_profile(x_));
        const auto note = [&](const burst& b, double from, double to) {
            for (const drive& d : b.drives)
                if (lanes_.row_of[d.tactor] >= 0)
                    profiles[static_cast<std::size_t>(lanes_.row_of[d.tactor])].add(from, to, d.amplitude);
        };
        for (const shown_burst& b : time_.bursts)
            if (b.to_s > b.from_s)
                note(*b.what, b.from_s, b.to_s);
        bool smooth = false;
        for (std::size_t i = 0; i < scene_.plans.size(); ++i)
            if (const plan& p = scene_.plans[i].schedule; p.at) {
                smooth = true;
                look_up(p, time_.starts_s[i], note);
            }
        for (std::size_t i = 0; i < lanes_.rows.size(); ++i)
            for (std::vector<spot>& shape : profiles[i].outlines(base_of(i), bar_height(1.0), smooth))
                canvas_.poly(std::move(shape), true,
                             {.fill = smooth ? grey : dark_grey, .stroke = ink, .width = smooth ? 0.5 : 0.1},
                             {.kind = "envelope", .data = {{"row", fmt::format("{}", i)}}});
    }

    template <class Note>
    void look_up(const plan& p, double start, Note&& note) const
    {
        const double columns = p.stroke_duration_s * x_.per_unit() / column_width;
        const auto n = static_cast<std::size_t>(std::clamp(columns * 2.0, 1.0, 4000.0));
        burst b;
        for (std::size_t k = 0; k < n; ++k) {
            const double t = p.stroke_duration_s * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
            p.at(t, b);
            note(b, start + t, start + t);
        }
    }

    void draw_conflicts()
    {
        const group g(canvas_, {.id = "conflicts"});
        std::size_t left = most_hatches;
        for (std::size_t i = 0; i < scene_.plans.size(); ++i)
            for (const conflict& k : scene_.plans[i].schedule.conflicts) {
                conflicts_ = true;
                const int row = lanes_.row_of[k.tactor];
                if (row < 0 || left == 0)
                    continue;
                --left;
                const double h = lanes_.height * full_bar;
                draw_hatch(canvas_,
                           {x_(time_.starts_s[i] + k.from_s), base_of(static_cast<std::size_t>(row)) - h,
                            (k.to_s - k.from_s) * x_.per_unit(), h},
                           {.kind = "conflict", .data = {{"tactor", fmt::format("{}", k.tactor)}}});
            }
    }

    double top_row_of(const burst& b) const
    {
        int row = static_cast<int>(lanes_.rows.size());
        for (const drive& d : b.drives)
            row = std::min(row, lanes_.row_of[d.tactor]);
        return top_ + row * lanes_.height;
    }

    void draw_dimensions()
    {
        if (first_ == nullptr)
            return;
        const std::string which = common_soa() ? "" : "first ";
        double y = where_.y + (colours_ ? strip_height : 0.0) + first_dimension;
        if (second_ != nullptr) {
            draw_dimension(canvas_, x_(first_->from_s), x_(second_->from_s), y,
                           std::max(top_row_of(*first_->what), top_row_of(*second_->what)),
                           fmt::format("{}SOA {} s", which, number(second_->from_s - first_->from_s, 4)),
                           {.id = "soa"});
            y += dimension_pitch;
        }
        draw_dimension(canvas_, x_(first_->from_s), x_(first_->to_s), y, top_row_of(*first_->what),
                       fmt::format("{}duration {} s", which, number(first_->to_s - first_->from_s, 4)),
                       {.id = "duration"});
    }

    bool common_soa() const
    {
        return std::all_of(scene_.plans.begin(), scene_.plans.end(),
                           [](const placed_plan& p) { return p.schedule.soa_s.has_value(); });
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
    lanes lanes_;
    scale x_;
    double top_ = 0.0;
    bool dense_ = false;
    bool conflicts_ = false;
    const shown_burst* first_ = nullptr;
    const shown_burst* second_ = nullptr;
};

} // namespace

double draw_timing_view(canvas& c, const scene& s, const timeline& t, box where, bool colours)
{
    return view(c, s, t, where, colours).draw();
}

} // namespace tactor::plot
