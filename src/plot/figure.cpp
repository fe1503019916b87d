// SPDX-License-Identifier: MIT
#include "plot/figure.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "plot/draw/array_frame.hpp"
#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {
namespace {

std::string describe_recording(const plan& p, const std::string& frequency)
{
    const std::string file = std::filesystem::path(waveform_text(p.wave)).filename().string();
    return p.wave.texture == texture_kind::time     ? file + " at its own rate"
           : p.wave.texture == texture_kind::length ? file + " along the path"
                                                    : file + " at " + frequency;
}

std::string describe_waveform(const plan& p)
{
    const bool noise = p.wave.kind == waveform_kind::noise;
    double low = noise ? p.wave.low_hz : p.carrier_hz;
    double high = noise ? p.wave.high_hz : p.carrier_hz;
    if (!noise && !p.course.empty()) {
        const auto [least, most] = std::ranges::minmax_element(p.course, {}, &carrier_point::hz);
        low = least->hz;
        high = most->hz;
    }
    std::string frequency = plain_number(low) + (low == high ? "" : " to " + plain_number(high)) + " Hz";
    switch (p.wave.kind) {
    case waveform_kind::sine:
        return frequency;
    case waveform_kind::recording:
        return describe_recording(p, frequency);
    default:
        return fmt::format("{} of {}", to_string(p.wave.kind), frequency);
    }
}

// Returns a text about a plan, such as the algorithm, if it is the same for all plans, otherwise "".
template <class Get>
std::string common(const scene& s, Get&& get)
{
    std::string first = get(s.plans.front().plan);
    for (const placed_plan& p : s.plans)
        if (get(p.plan) != first)
            return {};
    return first;
}

std::vector<std::string> details(const scene& s, const timeline& t)
{
    const std::string channels = !has_matching_channels(s.tactors) ? ""
                                 : s.tactors.tactors.size() == 1   ? "tactor 0 on channel 0"
                                                                   : "tactor n on channel n";
    if (s.plans.empty())
        return {counted(s.tactors.tactors.size(), "tactor"), channels};
    std::vector<std::string> d{clean(s.tactors.name)};
    double length = 0.0;
    for (const placed_plan& p : s.plans)
        length += p.plan.stroke_length_mm;
    const double lasts_s = s.plans.size() == 1 ? s.plans[0].plan.stroke_duration_s : t.total_s;
    d.push_back(common(s, [](const plan& p) { return p.algorithm; }));
    d.push_back(common(s, describe_phantom));
    if (s.plans.size() > 1)
        d.push_back(fmt::format("{} strokes", s.plans.size()));
    if (!t.sampled)
        d.push_back(counted(t.bursts.size(), "burst"));
    d.push_back(
        fmt::format("{} mm in {}", plain_number(length, length < 1000.0 ? 4 : 5), seconds_text(lasts_s, 4)));
    d.push_back(channels);
    d.push_back(common(s, describe_sound));
    return d;
}

// Draws the meaning of the colours below an array that is shown without other views.
double draw_time_key(canvas& c, const timeline& t, box where)
{
    const scale x{0.0, std::max(t.total_s, 1e-9), where.x + 6.0, where.right() - 10.0};
    draw_time_strip(c, {x.page_from, where.y, x.page_to - x.page_from, 6.0});
    draw_horizontal_axis(c, x, where.y + 6.0, where.y + 6.0, "time (s)");
    return 6.0 + axis_height;
}

// Greatest heights of the array and of the picture, pt.
struct bounds {
    double array = std::numeric_limits<double>::infinity();
    double picture = std::numeric_limits<double>::infinity();
};

struct drawn {
    canvas picture = {};
    double array_height = 0.0;
};

drawn draw_scene(const scene& s, const timeline& t, const figure_options& o, const bounds& most)
{
    drawn d;
    canvas& c = d.picture;
    c.width = o.width_mm * pt_per_mm;
    c.loop_s = o.animated ? t.total_s + loop_pause_s : 0.0;
    const bool with_array = o.view == figure_view::array || o.view == figure_view::both || s.plans.empty();
    c.title = s.plans.empty() ? clean(s.tactors.name)
                              : fmt::format("{} on {}", clean(s.name), clean(s.tactors.name));
    c.description = join(details(s, t), ", ");
    box rest{margin, margin, c.width - 2.0 * margin, 0.0};
    if (o.heading) {
        const group g(c, {.id = "heading"});
        rest.y += draw_heading(c, s.name, c.description, rest) + 3.0;
    }
    if (with_array) {
        rest.height = 0.8 * c.width;
        d.array_height = draw_array_view(c, s, t, rest, most.array);
        rest.y += d.array_height + 4.0;
    }
    if (o.view == figure_view::timing)
        rest.y += 4.0;
    rest.y += draw_stroke_legend(c, s, t, rest, o.view != figure_view::wave);
    rest.height = most.picture - margin - rest.y;
    if (s.plans.empty())
        rest.y -= 4.0;
    else if (o.view == figure_view::array && !t.has_several_strokes())
        rest.y += draw_time_key(c, t, rest);
    else if (o.view == figure_view::wave)
        rest.y += draw_wave_view(c, s, t, rest);
    else if (o.view != figure_view::array)
        rest.y += draw_timing_view(c, s, t, rest, !t.has_several_strokes());

    c.height = rest.y + margin;
    return d;
}

// Returns the greatest height of a picture: that of A4 without margins, or proportionally more for wider
// pictures.
double page_height(double width)
{
    constexpr double a4_width = 170.0;
    constexpr double a4_height = 247.0;
    return std::max(a4_height * pt_per_mm, width * a4_height / a4_width);
}

} // namespace

std::string describe_phantom(const plan& p)
{
    return p.faces == faces_kind::delaunay ? p.phantom
                                           : fmt::format("{} (faces {})", p.phantom, to_string(p.faces));
}

std::string describe_sound(const plan& p)
{
    std::string text = describe_waveform(p);
    if (p.am.hz > 0.0)
        text += fmt::format(", AM of {} Hz", plain_number(p.am.hz));
    if (p.am.hz > 0.0 && p.am.depth != 1.0)
        text += fmt::format(" and depth {}", plain_number(p.am.depth));
    return text;
}

canvas make_canvas(double width_mm)
{
    if (!(width_mm >= least_width_mm && width_mm <= most_width_mm))
        throw error(error_kind::bad_input, "picture",
                    fmt::format("a width of {} mm is out of range", width_mm),
                    fmt::format("use {} to {} mm", least_width_mm, most_width_mm));
    canvas c;
    c.width = width_mm * pt_per_mm;
    return c;
}

std::string scene_name(const std::vector<stroke>& strokes, const std::string& file)
{
    return strokes.size() == 1 && !strokes[0].name.empty() ? strokes[0].name : file;
}

canvas draw_figure(const scene& s, const figure_options& o)
{
    constexpr double least_array = 0.35; // fraction of the page
    const timeline t = make_timeline(s);
    if (o.animated && !t.sampled && t.bursts.size() > most_animated_bursts)
        throw error(error_kind::bad_input, "picture",
                    fmt::format("an animated picture can have at most {} bursts, but there are {}",
                                most_animated_bursts, t.bursts.size()),
                    "draw a part of the stroke, or a still picture");
    drawn d = draw_scene(s, t, o, {});
    const double page = page_height(d.picture.width);
    if (d.picture.height > page) {
        const double notes = note_height * static_cast<double>(most_array_notes);
        const double height = d.array_height - notes - (d.picture.height - page);
        d = draw_scene(s, t, o, {std::max(least_array * page, height), page});
    }
    return std::move(d.picture);
}

} // namespace tactor::plot
