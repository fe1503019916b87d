// SPDX-License-Identifier: MIT
#include "session/piece.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "core/start_times.hpp"
#include "core/trajectory/recorded_points.hpp"
#include "core/words.hpp"
#include "percept/observer.hpp"
#include "plan/curve_impl.hpp"

namespace tactor::session {
namespace {

template <class... F>
struct overloaded : F... {
    using F::operator()...;
};
template <class... F>
overloaded(F...) -> overloaded<F...>; // clang 14 needs it

stroke named_stroke(const std::string& name)
{
    const auto& shapes = stroke_shapes();
    const bool is_shape = std::find(shapes.begin(), shapes.end(), name) != shapes.end();
    return is_shape ? shape_stroke(name) : preset_stroke(name);
}

// Sets the duration of a stroke from the option, else from the stroke's own pace, else from the default.
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

// Fits each stroke that requests it. The margin is a key of the stroke's file, not an option.
void apply_file_fits(piece& p, const layout& faces)
{
    try {
        p.strokes = apply_fits(std::move(p.strokes), faces);
    } catch (const error& e) {
        if (e.field() != "margin_mm")
            throw;
        throw e.reworded(p.name.empty() ? "stroke" : p.name, fmt::format("fit_margin_mm: {}", e.why()),
                         e.hint());
    }
}

compensated_plan plan_one(const array& a, const layout& faces, const stroke& s,
                          const options::option_values& o)
{
    return detail::plan_for_observer(a, faces, s, o.plan, o.compensate ? &o.low_speed : nullptr);
}

void call(const before_stroke& next, std::size_t i)
{
    if (next)
        next(i);
}

[[noreturn]] void refuse_different(const std::string& name, const std::string& a, const std::string& b)
{
    throw error(error_kind::bad_input, name, fmt::format("the plans have different values, {} and {}", a, b),
                fmt::format("give {}= here, for all plans", name))
        .with_field(name);
}

std::string value_text(const std::optional<double>& d)
{
    return d ? plain_number(*d) : "none";
}

// Throws error if two sounds differ in options that a score has only once.
void check_common_options(const render_options& a, const render_options& b)
{
    const auto check = [](const char* name, const auto& x, const auto& y, auto text) {
        if (x != y)
            refuse_different(name, text(x), text(y));
    };
    check("rate", a.rate, b.rate, [](unsigned hz) { return fmt::format("{} Hz", hz); });
    check("phase", a.phase, b.phase, [](phase_kind k) { return std::string(to_string(k)); });
    check("ramp", a.ramp_s, b.ramp_s, value_text);
    check("attack", a.envelope.attack_s, b.envelope.attack_s, value_text);
    check("release", a.envelope.release_s, b.envelope.release_s, value_text);
    check("envelope", a.envelope, b.envelope, envelope_text);
    check("together", a.together, b.together, [](together_kind k) { return std::string(to_string(k)); });
    if (a.sl_db.has_value() != b.sl_db.has_value())
        refuse_different("sl", value_text(a.sl_db), value_text(b.sl_db));
    if (a.marker_channel && b.marker_channel)
        check("marker_channel", *a.marker_channel, *b.marker_channel,
              [](unsigned c) { return std::to_string(c); });
}

// Returns the sound common to all plans, with the level of the loudest.
render_options join_sounds(const std::vector<sounding_plan>& plans)
{
    render_options all = plans.front().sound;
    for (const sounding_plan& p : plans) {
        const render_options& o = p.sound;
        check_common_options(all, o);
        all.channels = std::max(all.channels, o.channels);
        if (!all.marker_channel && o.marker_channel) {
            all.marker_channel = o.marker_channel;
            all.marker_s = o.marker_s;
        }
        if (level_db(o) > level_db(all)) {
            all.level_dbfs = o.level_dbfs;
            all.sl_db = o.sl_db;
        }
    }
    return all;
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

source make_source(std::string_view name, const std::string& text)
{
    if (name == "stroke")
        return stroke_name{text};
    if (name == "path")
        return path_data{text};
    return format_text{detail::find_format_by_name(name), text};
}

stroke path_stroke(const std::string& data, std::optional<double> duration_s, double speed_mm_s,
                   std::optional<double> rest_s)
{
    const path p = path::from_svg(data);
    if (!duration_s && p.length_mm() == 0.0)
        duration_s = rest_s;
    stroke s{.name = "path", .motion = trajectory::along(p, duration_s.value_or(p.length_mm() / speed_mm_s))};
    s.speed_mm_s = speed_mm_s;
    return s;
}

stroke points_stroke(const std::string& name, std::span<const timed_point> points, double intensity_max)
{
    detail::recorded_points recorded(intensity_max);
    recorded.reserve(points.size());
    for (const timed_point& p : points)
        recorded.add(p);
    const trajectory motion = trajectory::timed(recorded.take());
    return {.name = name, .motion = motion, .warnings = recorded.warnings()};
}

namespace {

// Returns the duration of the vibration that the options set as waveform, if any.
std::optional<double> vibration_s(const options::option_values& o)
{
    const auto& recorded = o.plan.wave.recorded;
    return recorded && recorded->source ? std::optional(recorded->source->duration_s) : std::nullopt;
}

// Lets a touch that rests last as long as its vibration, unless the options set its duration. Makes it
// continuous, because bursts would end later.
std::vector<stroke> match_vibration_duration(stroke s, const options::option_values& o)
{
    const std::optional<double> own_s = vibration_s(o);
    if (own_s && s.motion.length_mm() == 0.0) {
        s.motion = s.motion.with_duration(o.duration_s.value_or(*own_s));
        if (!o.gives("algorithm"))
            s.choices.algorithm = algorithm_kind::continuous;
    }
    return std::vector{std::move(s)};
}

} // namespace

std::vector<stroke> read_strokes(source from, const std::string& named, const options::option_values& o)
{
    const double intensity_max = o.intensity_max.value_or(1.0);
    const std::string position = o.position.value_or("");
    const actuator_numbers* const actuator = o.actuator ? &*o.actuator : nullptr;
    if (!position.empty() && !std::holds_alternative<format_text>(from) &&
        !std::holds_alternative<stroke_file>(from) && !std::holds_alternative<std::vector<stroke>>(from))
        throw error(error_kind::bad_input, "position", fmt::format("{} has no positions", named),
                    "leave out {position}, which chooses a part of a .tact file")
            .with_field("position");
    const double speed_mm_s = o.speed_mm_s.value_or(o.usual_speed_mm_s.value_or(default_speed_mm_s));
    return std::visit(
        overloaded{
            [&](const stroke_name& s) { return match_vibration_duration(named_stroke(s.name), o); },
            [&](const path_data& s) {
                return match_vibration_duration(path_stroke(s.data, o.duration_s, speed_mm_s, vibration_s(o)),
                                                o);
            },
            [&](const std::vector<timed_point>& s) {
                return std::vector{points_stroke("points", s, intensity_max)};
            },
            [&](const format_text& s) {
                return detail::read_stroke_text(*s.format,
                                                {s.text, named, intensity_max, nullptr, position, actuator});
            },
            [&](const stroke_file& s) {
                return detail::load_stroke_file(s.file, intensity_max, position, actuator);
            },
            [](std::vector<stroke>& s) { return std::move(s); },
            [](piece& s) { return std::move(s.strokes); },
            [](const samples_file&) { return std::vector<stroke>(); },
        },
        from);
}

void use_actuator(waveform& w, const std::optional<actuator_numbers>& a)
{
    if (!a || !w.recorded || !w.recorded->source || w.recorded->source->own_actuator)
        return;
    recording on_it = *w.recorded;
    on_it.source->actuator = *a;
    w.recorded = std::make_shared<const recording>(std::move(on_it));
}

bool has_fit(std::span<const stroke> strokes)
{
    return std::ranges::any_of(strokes, [](const stroke& k) { return k.fit.has_value(); });
}

void place_strokes(piece& p, const layout& faces, const options::option_values& o)
{
    p.had_own_fit = has_fit(p.strokes);
    apply_file_fits(p, faces);
    for (stroke& k : p.strokes)
        if (k.sound.wave)
            use_actuator(*k.sound.wave, o.actuator);
    if (o.fit) {
        fitted_strokes fitted = fit_strokes(p.strokes, faces, o.fit_margin_mm);
        p.strokes = std::move(fitted.strokes);
        p.fit = fitted.placed;
    }
    // The time depends on the final length of a stroke.
    for (stroke& k : p.strokes)
        set_pace(k, o);
}

piece read_piece(source from, std::string name, const layout& faces, const options::option_values& o)
{
    if (auto* planned = std::get_if<piece>(&from)) {
        planned->name = std::move(name);
        for (placed_plan& made : planned->plans)
            use_actuator(made.plan.wave, o.actuator);
        return std::move(*planned);
    }
    piece p{.name = std::move(name)};
    if (const auto* samples = std::get_if<samples_file>(&from)) {
        p.samples = samples->file;
        return p;
    }
    p.strokes = read_strokes(std::move(from), p.name, o);
    place_strokes(p, faces, o);
    return p;
}

void plan_stroke(piece& p, std::size_t i, const array& a, const layout& faces,
                 const options::option_values& o)
{
    const stroke& k = p.strokes[i];
    compensated_plan made = plan_one(a, faces, k, o);
    p.plans.push_back({std::move(made.plan), k.start_s, k.anchor});
    if (o.compensate)
        p.moved.push_back(std::move(made));
}

void plan_piece(piece& p, const array& a, const layout& faces, const options::option_values& o,
                const before_stroke& next)
{
    detail::start_times times;
    for (std::size_t i = 0; i < p.strokes.size(); ++i) {
        call(next, i);
        if (i == p.plans.size())
            plan_stroke(p, i, a, faces, o);
        times.start(p.plans[i].start_s, p.plans[i].anchor);
        times.set_duration(p.plans[i].plan.total_s);
    }
}

score make_score(piece& p, const array& a, const layout& faces, const options::option_values& o,
                 const render_options& r, const before_stroke& next)
{
    if (!p.samples.empty())
        return score::from_samples(a, load_samples(p.samples), r);
    score_builder made(a, r);
    for (std::size_t i = 0; i < p.strokes.size(); ++i) {
        call(next, i);
        const stroke& k = p.strokes[i];
        if (i < p.plans.size())
            made.add(std::move(p.plans[i].plan), p.plans[i].start_s, p.plans[i].anchor);
        else if (o.compensate)
            made.add(plan_one(a, faces, k, o).plan, k.start_s, k.anchor);
        else
            made.add(faces, k, o.plan);
    }
    p.plans.clear();
    call(next, p.strokes.size());
    return made.take();
}

score make_score(const piece& p, const array& a, const render_options& r, const before_stroke& next)
{
    score_builder made(a, r);
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        call(next, i);
        made.add(p.plans[i].plan, p.plans[i].start_s, p.plans[i].anchor);
    }
    call(next, p.plans.size());
    return made.take();
}

score make_score(const plan& p, const array& a, const render_options& r, std::uint64_t rounds, double round_s)
{
    score_builder made(a, r);
    for (std::uint64_t k = 0; k < rounds; ++k)
        made.add(p, static_cast<double>(k) * round_s);
    return made.take();
}

joined_score join_plans(const array& a, std::vector<sounding_plan> plans)
{
    if (plans.empty())
        throw error(error_kind::bad_input, "plans", "there are none", "give at least one");
    const render_options common = set_default_channels(a, join_sounds(plans));
    std::vector<double> levels;
    score_builder made(a, common);
    for (sounding_plan& p : plans) {
        levels.push_back(level_db(p.sound));
        plan& one = p.placed.plan;
        if (levels.back() != level_db(common))
            one =
                detail::scale_plan(std::move(one), std::pow(10.0, (levels.back() - level_db(common)) / 20.0));
        made.add(std::move(one), p.placed.start_s, p.placed.anchor);
    }
    return {made.take(), common, std::move(levels)};
}

double level_db(const render_options& r) noexcept
{
    return r.sl_db.value_or(r.level_dbfs);
}

render_options set_default_channels(const array& a, render_options r)
{
    const unsigned marker = r.marker_channel ? *r.marker_channel + 1 : 0;
    if (r.channels == 0)
        r.channels = std::max(a.channels(), marker);
    return r;
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
    return fmt::format(
        "weakened by {:.2f} dB: {} on tactor {} at {} (use {{together=sum}} to let strokes add up)",
        -w.weakened_db, subject, w.tactor, seconds_text(w.at_s));
}

} // namespace tactor::session
