// SPDX-License-Identifier: MIT
#include "session/piece.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/stroke_format.hpp"

namespace tactor::session {
namespace {

stroke stroke_of_path(const std::string& data, const options::option_values& o)
{
    const path p = path::from_svg(data);
    const double speed = o.speed_mm_s.value_or(o.usual_speed_mm_s.value_or(default_speed_mm_s));
    stroke k{.name = "path", .motion = trajectory::along(p, o.duration_s.value_or(p.length_mm() / speed))};
    k.speed_mm_s = speed;
    return k;
}

stroke named_stroke(const std::string& name)
{
    const auto& shapes = stroke_shapes();
    const bool is_shape = std::find(shapes.begin(), shapes.end(), name) != shapes.end();
    return is_shape ? shape_stroke(name) : preset_stroke(name);
}

// Sets the duration of a stroke: the option comes first, then the stroke's own pace, then the default.
void set_pace(stroke& s, const options::option_values& o)
{
    const std::optional<double> speed = o.speed_mm_s || !s.usual_pace ? o.speed_mm_s : o.usual_speed_mm_s;
    if (o.duration_s)
        s.motion = s.motion.with_duration(*o.duration_s);
    else if (speed) {
        s.motion = s.motion.with_speed(*speed);
        s.speed_mm_s = speed;
    }
}

} // namespace

const std::vector<std::string_view>& source_names()
{
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all{"stroke", "path", "points"};
        for (const detail::stroke_format* f : detail::stroke_formats())
            all.push_back(f->name);
        return all;
    }();
    return names;
}

std::vector<stroke> read_strokes(std::string_view kind, const std::string& text, const std::string& named,
                                 const options::option_values& o)
{
    if (kind == "stroke")
        return {named_stroke(text)};
    if (kind == "path")
        return {stroke_of_path(text, o)};
    return detail::find_format_by_name(kind)->parse({text, named, o.intensity_max.value_or(1.0)});
}

void place_strokes(piece& p, const layout& faces, const options::option_values& o)
{
    p.strokes = apply_fits(std::move(p.strokes), faces);
    if (o.fit) {
        fitted_strokes fitted = fit_strokes(p.strokes, faces, o.fit_margin_mm);
        p.strokes = std::move(fitted.strokes);
        p.fit = fitted.placed;
    }
    // The time depends on the final length of a stroke.
    for (stroke& k : p.strokes)
        set_pace(k, o);
}

void plan_stroke(piece& p, std::size_t i, const array& a, const layout& faces,
                 const options::option_values& o)
{
    const stroke& k = p.strokes[i];
    if (!o.compensate) {
        p.plans.push_back({make_plan(a, faces, k, o.plan), k.start_s, k.anchor});
        return;
    }
    p.moved.push_back(make_compensated_plan(a, faces, k, o.plan, o.low_speed));
    p.plans.push_back({std::move(p.moved.back().plan), k.start_s, k.anchor});
}

std::string weakening_text(const weakening& w, std::size_t strokes)
{
    if (!(w.weakened_db < 0.0))
        return "";
    std::string subject = "it exceeds the level";
    if (w.plans.size() == 1 && strokes > 1)
        subject = fmt::format("stroke {} exceeds the level", w.plans.front() + 1);
    if (w.plans.size() > 1) {
        subject = fmt::format("strokes {}", w.plans.front() + 1);
        for (std::size_t i = 1; i < w.plans.size(); ++i)
            subject += fmt::format("{}{}", i + 1 < w.plans.size() ? ", " : " and ", w.plans[i] + 1);
        subject += " meet";
    }
    return fmt::format("weakened by {:.2f} dB: {} on tactor {} at {} ({{together=sum}} lets them add up)",
                       -w.weakened_db, subject, w.tactor, seconds_text(w.at_s));
}

} // namespace tactor::session
