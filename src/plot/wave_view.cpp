// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/render.hpp>

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"
#include "synth/score/score_view.hpp"

namespace tactor::plot {
namespace {

constexpr double most_samples = 2e10;
constexpr std::size_t most_block_samples = 1U << 16U;

/// Ranges of the samples of some channels, in stretches of equal length.
struct waveform {
    double stretch_s = 0.0;
    std::vector<std::vector<column_range>> by_channel = {}; ///< in the order of the requested channels
    std::vector<float> peaks = {};                          ///< greatest magnitude of each channel
};

/// Renders a score and measures it in `stretches` stretches. The number is smaller if a stretch would be
/// shorter than a frame.
/// \throws error (bad_input) for more than 2e10 samples.
waveform measure(const score& s, const std::vector<unsigned>& channels, std::size_t stretches)
{
    const std::uint64_t frames = s.frames();
    const double samples = static_cast<double>(frames) * s.channels();
    if (samples > most_samples)
        throw error(error_kind::bad_input, "--view wave",
                    fmt::format("{:.3g} samples are too many to draw", samples),
                    "draw a shorter stroke, or use a lower --rate");
    const std::size_t per_frame = s.channels();
    const auto block = std::max<std::size_t>(1, most_block_samples / per_frame);
    const std::uint64_t length =
        std::max<std::uint64_t>(1, (frames + stretches - 1) / std::max<std::size_t>(1, stretches));
    waveform w;
    w.stretch_s = static_cast<double>(length) / s.rate();
    w.by_channel.assign(channels.size(), std::vector<column_range>((frames + length - 1) / length));
    w.peaks.assign(channels.size(), 0.0F);
    renderer r(s, format_kind::float32);
    synth::sample_ranges ranges(per_frame);
    std::vector<float> buffer(block * per_frame);
    for (std::uint64_t at = 0; at < frames;) {
        // Limits the block so that it is in one stretch only.
        const auto n = static_cast<std::size_t>(
            std::min({static_cast<std::uint64_t>(block), frames - at, length - at % length}));
        r.process(std::as_writable_bytes(std::span(buffer).first(n * per_frame)));
        ranges.add(buffer.data(), n);
        at += n;
        if (at % length != 0 && at != frames)
            continue;
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const auto [low, high] = ranges.range_at(channels[c]);
            w.by_channel[c][(at - 1) / length] = {low, high};
            w.peaks[c] = std::max({w.peaks[c], std::abs(low), std::abs(high)});
        }
        ranges.clear();
    }
    return w;
}

constexpr double highest_wave = 17.6; // height of a row, pt; larger than in the timing diagram
constexpr double peak_column = 26.0;  // width of the levels on the right, pt
constexpr double least_cycle = 1.5;   // pt; for shorter cycles the envelope is drawn
constexpr double carrier_column = 0.2;
constexpr double wave_heading_height = 12.0;
constexpr double wave_legend_height = 10.0;
constexpr double least_peak_row = 5.6;
constexpr std::size_t most_wave_notes = 3; // number of lines
constexpr double most_around_waves = 88.0; // pt: heading, starts, axis, legend and notes

class wave_drawing {
public:
    wave_drawing(canvas& c, const scene& s, const timeline& t, box where)
        : canvas_(c),
          time_(t),
          where_(where),
          lanes_(make_lanes(s.tactors, t.playing, where.height - most_around_waves))
    {
        const double total = std::max(static_cast<double>(s.sound->frames()) / s.sound->rate(), 1e-9);
        const double left = where.x + lanes_.label_width + 4.0;
        x_ = {0.0, total, left, where.right() - peak_column};
        top_ = where.y + wave_heading_height + starts_height(t);
        const double space = where.bottom() - top_ - axis_gap - axis_height - wave_legend_height -
                             note_height * static_cast<double>(most_wave_notes);
        lanes_.fit(space, highest_wave);
        double highest = 0.0;
        double lowest = std::numeric_limits<double>::infinity();
        for (const placed_plan& p : s.plans) {
            highest = std::max(highest, p.plan.carrier_hz);
            lowest = std::min(lowest, p.plan.carrier_hz);
        }
        // A column contains either part of a cycle or whole cycles.
        const double width = x_.page_to - x_.page_from;
        const bool carrier = x_.points_per_unit() / highest >= least_cycle;
        const double columns =
            carrier ? width / carrier_column : std::min(width / column_width, total * lowest);
        std::vector<unsigned> channels; // channels in the order of the rows
        for (const unsigned i : t.playing)
            channels.push_back(s.tactors.tactors[i].channel);
        wave_ = measure(*s.sound, channels, static_cast<std::size_t>(std::max(1.0, columns)));
    }

    double draw()
    {
        const group all(canvas_, {.id = "wave",
                                  .data = {{"x0", fmt::format("{:.9g}", x_(0.0))},
                                           {"x-scale", fmt::format("{:.9g}", x_.points_per_unit())}}});
        for (const float p : wave_.peaks)
            peak_ = std::max(peak_, static_cast<double>(p));
        const double bottom = top_ + lanes_.total_height();
        draw_horizontal_axis(canvas_, x_, bottom + axis_gap, top_, "time (s)");
        draw_headings();
        for (std::size_t i = 0; i < lanes_.rows.size(); ++i)
            draw_row(i);
        notes_.push_back(draw_stroke_starts(canvas_, time_, x_, top_, bottom));
        const double y = bottom + axis_gap + axis_height + wave_legend_height / 2.0;
        if (peak_ > 0.0)
            canvas_.text({where_.x, y + cap_height(small_text) / 2.0},
                         fmt::format("height of a row: \xC2\xB1 {} of full scale", number(peak_, 3)),
                         {.size = small_text});
        const double end = y + wave_legend_height / 2.0;
        return end - where_.y +
               draw_notes(canvas_, notes_, {where_.x, end, where_.width, 0.0}, most_wave_notes);
    }

private:
    void draw_headings()
    {
        notes_ = {draw_lane_labels(canvas_, lanes_, x_.page_from - 3.0, top_)};
        const double y = top_ - 4.0 - starts_height(time_);
        canvas_.text({x_.page_from - 3.0, y}, lanes_.heading,
                     {.size = small_text, .anchor = align::end, .ink = dark_grey});
        if (shows_peaks())
            canvas_.text({where_.right(), y}, "peak (dBFS)",
                         {.size = small_text, .anchor = align::end, .ink = dark_grey});
        else
            notes_.push_back("no space for the peaks of rows");
    }

    bool shows_peaks() const { return lanes_.height >= least_peak_row - 1e-9; }

    void draw_row(std::size_t row)
    {
        const double middle = top_ + lanes_.top(row) + lanes_.height / 2.0;
        const double top = middle - 0.46 * lanes_.height;
        const scale columns{0.0, x_.to / wave_.stretch_s, x_.page_from, x_.page_to};
        const group g(canvas_, {.kind = "channel", .data = {{"row", fmt::format("{}", row)}}});
        canvas_.line({x_.page_from, middle}, {x_.page_to, middle}, {.stroke = light_grey, .width = 0.4});
        std::size_t first = 0;
        for (std::size_t i = 0; i < row; ++i)
            first += lanes_.rows[i].tactors.size();
        float loudest = 0.0F;
        for (std::size_t k = first; k < first + lanes_.rows[row].tactors.size(); ++k)
            loudest = std::max(loudest, wave_.peaks[k]);
        if (!(loudest > 0.0F))
            return;
        for (std::size_t k = first; k < first + lanes_.rows[row].tactors.size(); ++k)
            for (std::vector<spot>& shape : outline(wave_.by_channel[k], columns, {0.0, peak_, middle, top}))
                canvas_.poly(std::move(shape), true, {.fill = grey, .stroke = ink, .width = 0.35},
                             {.kind = "envelope"});
        if (shows_peaks())
            canvas_.text({where_.right(), middle + cap_height(small_text) / 2.0},
                         fmt::format("{:.1f}", 20.0 * std::log10(static_cast<double>(loudest))),
                         {.size = small_text, .anchor = align::end}, {.kind = "peak"});
    }

    canvas& canvas_;
    const timeline& time_;
    box where_;
    lanes lanes_;
    std::vector<std::string> notes_ = {};
    scale x_;
    double top_ = 0.0;
    waveform wave_;
    double peak_ = 0.0;
};

} // namespace

double draw_wave_view(canvas& c, const scene& s, const timeline& t, box where)
{
    return wave_drawing(c, s, t, where).draw();
}

} // namespace tactor::plot
