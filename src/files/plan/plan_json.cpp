// SPDX-License-Identifier: MIT
#include "files/plan/plan_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "files/json/writer.hpp"
#include "files/output_file.hpp"
#include "files/plan/plan_members.hpp"

namespace tactor::files {
namespace {

using detail::about;
using detail::comparison;
using detail::comparison_row;
using detail::interval;
using detail::nullable;
using detail::prediction;
using detail::row_spread;

/// Members of plan_parts, as references to a plan that is written.
struct written_plan {
    const std::string& name;
    note_kind note;
    double start_s;
    bool follows; ///< true if it starts at the frame at which the previous stroke ends
    const tactor::plan& plan;
    plan_sound sound;
    const std::optional<fitting>& fit;
    const array& tactors;
    const render_options& options;
    std::optional<compensated_plan> moved;
    bool is_sampled;
    double step_s;
    std::uint64_t start_frame;
    std::uint64_t frames;
    const weakening& weakened;
};

template <class T>
nullable<T> where(bool exists, const T& v)
{
    return exists ? nullable<T>{v} : nullable<T>{};
}

// Simulated people, drawn at random for an observer.
struct drawn_people {
    detail::spread_choice choice = {};
    bool by_taps = false;
};

// Returns true if the low-speed observer has made a prediction.
bool has_taps(const prediction& r, observer_kind by)
{
    return by == observer_kind::low_speed && r.unpredicted.empty();
}

} // namespace

thresholds find_thresholds(const tactor_spec& t)
{
    if (t.thresholds.empty())
        return t.threshold_dbfs ? thresholds{*t.threshold_dbfs} : thresholds{};
    std::vector<std::array<double, 2>> all;
    for (const threshold_point& p : t.thresholds)
        all.push_back({p.hz, p.dbfs});
    return {all};
}

void set_thresholds(tactor_spec& t, const thresholds& v)
{
    if (!v.value)
        return;
    if (const double* const one = std::get_if<double>(&*v.value))
        t.threshold_dbfs = *one;
    else
        for (const auto& [hz, dbfs] : std::get<1>(*v.value))
            t.thresholds.push_back({hz, dbfs});
}

nlohmann::ordered_json describe_site(const array& a)
{
    auto site = nlohmann::ordered_json::object();
    for (const auto& [key, text] : {std::pair("site", &a.site), std::pair("up", &a.up)})
        if (!text->empty())
            site[key] = *text;
    if (a.place)
        site["place"] = {a.place->x_mm, a.place->y_mm};
    for (const auto& [key, value] : {std::pair("turn", a.turn_deg), std::pair("body", a.body_mm)})
        if (value)
            site[key] = *value;
    return site;
}

std::vector<std::optional<double>> list_peaks_dbfs(const array& a, double carrier_hz, const render_options& o,
                                                   double weakened_db)
{
    std::vector<std::optional<double>> all;
    for (const tactor_spec& t : a.tactors) {
        all.emplace_back(o.level_dbfs + t.gain_db + weakened_db);
        if (!o.sl_db)
            continue;
        const auto threshold = threshold_at(t, carrier_hz);
        all.back() = threshold ? std::optional(*threshold + *o.sl_db + weakened_db) : std::nullopt;
    }
    return all;
}

std::optional<fit_matrix> make_matrix(const std::optional<fitting>& f)
{
    if (!f)
        return {};
    const auto matrix = [&f](double a, double across, double d) {
        const point origin = (*f)({0.0, 0.0});
        return fit_matrix{f->margin_mm, {a, across, across, d, origin.x_mm, origin.y_mm}};
    };
    if (!f->line)
        return matrix(f->scale, 0.0, f->scale);
    const auto [x, y] = *f->line;
    return matrix(f->scale * x * x, f->scale * x * y, f->scale * y * y);
}

fitting make_fitting(const fit_matrix& content)
{
    const auto& m = content.matrix;
    fitting f{.to = {m[4], m[5]}, .scale = m[0], .margin_mm = content.margin_mm};
    if (m[0] != m[3] || m[1] != 0.0) {
        f.scale = m[0] + m[3];
        f.line = {std::sqrt(m[0] / f.scale), std::copysign(std::sqrt(m[3] / f.scale), m[1])};
    }
    return f;
}

std::string note_text(note_kind n)
{
    return n == note_kind::reconstructed
               ? "reconstructed: the figure that shows it is not in the paper's text"
               : "";
}

plan_sound make_plan_sound(const plan& p)
{
    const waveform& w = p.wave;
    plan_sound s;
    if (w.kind != waveform_kind::sine)
        s.waveform = waveform_text(w);
    if (w.kind == waveform_kind::noise)
        s.noise_seed = w.seed;
    if (w.kind == waveform_kind::recording) {
        // Absolute, because the plan may be played in another folder.
        std::error_code nowhere;
        if (const auto whole = std::filesystem::absolute(*s.waveform, nowhere); !nowhere)
            s.waveform = whole.string();
        s.recording = {*s.waveform, w.recorded->sha256, w.recorded->samples.size(), w.recorded->rate_hz};
        s.texture = w.texture;
        if (w.texture == texture_kind::length)
            s.texture_mm = w.texture_mm;
    }
    if (p.am.hz > 0.0) {
        s.am_hz = p.am.hz;
        s.am_depth = p.am.depth;
    }
    if (!p.course.empty())
        s.course = p.course;
    return s;
}

double piece::total_s() const
{
    double end = 0.0;
    const std::vector<double> starts = starts_s();
    for (std::size_t i = 0; i < plans.size(); ++i)
        end = std::max(end, starts[i] + plans[i].plan.total_s);
    return end;
}

void write_plans(const plan_record& r, const text_sink& out)
{
    const auto starts = r.made.starts_s();
    const auto write = [&](std::size_t i) {
        std::string text;
        text += '{';
        const plan& p = r.made.plans[i].plan;
        const written_plan parts{r.made.strokes[i].name,
                                 r.made.strokes[i].note,
                                 starts[i],
                                 !r.made.plans[i].start_s,
                                 p,
                                 make_plan_sound(p),
                                 r.made.fit,
                                 r.tactors,
                                 r.options,
                                 r.made.moved.empty() ? std::nullopt : std::optional(r.made.moved[i]),
                                 p.curve.has_value(),
                                 continuous_step_s,
                                 r.samples.starts()[i],
                                 r.samples.frames(),
                                 r.samples.weakened()};
        json_writer io(text, &out);
        describe_plan_members(io, parts);
        out(text + '}');
    };
    if (r.made.plans.size() == 1) {
        write(0);
        out("\n");
        return;
    }
    out("{\"schema\":\"tactor-plans/1\",\"plans\":[\n");
    for (std::size_t i = 0; i < r.made.plans.size(); ++i) {
        write(i);
        out(i + 1 < r.made.plans.size() ? ",\n" : "\n");
    }
    out("]}\n");
}

std::string plans_text(const plan_record& r)
{
    std::string text;
    write_plans(r, [&text](std::string_view part) { text += part; });
    return text;
}

void save_plans(const std::string& text, const std::filesystem::path& file, bool force,
                detail::owner_kind writer)
{
    detail::write_text(file, text, {}, force, writer);
}

nlohmann::ordered_json plan_schema()
{
    plan_parts parts;
    return json_schema::describe_object([&parts](auto& io) { describe_plan_members(io, parts); });
}

template <class Io, either<detail::observer_choice> Observer>
void members(Io& io, Observer& o)
{
    constexpr about parameters{"its parameters, for low-speed", detail::above_0};
    const bool taps = o.kind == observer_kind::low_speed;
    io("name", o.kind, {"centroid or low-speed"});
    io("sigma_mm", where(taps, o.low_speed.sigma_mm), parameters);
    io("sigma_v_mm_s", where(taps, o.low_speed.sigma_v_mm_s), parameters);
    io("built_for", where(taps, std::string("taps")), {"taps for low-speed; null for centroid"});
}

template <class Io, either<drawn_people> People>
void members(Io& io, People& p)
{
    constexpr about differ{"how much they differ; the first is null with the observer centroid",
                           detail::from_0};
    io("people", p.choice.people, {"number of people"});
    io("seed", p.choice.seed, {"seed of the draw"});
    io("sigma_factor", where(p.by_taps, p.choice.sigma_factor), differ);
    io("threshold_db", p.choice.threshold_db, differ);
    io("place_mm", p.choice.place_mm, differ);
    io("parts", std::array{0.05, 0.95},
       {"0.05 and 0.95: shares of the people below the two ends of each interval"});
}

template <class Io, either<row_spread> Spread>
void members(Io& io, Spread& s)
{
    const auto ends = [](const std::optional<interval>& v) {
        return v ? nullable<std::array<double, 2>>{{{v->low, v->high}}} : nullable<std::array<double, 2>>{};
    };
    constexpr about figure{
        "interval of the figure with the same name; null if that figure is null for any of these people"};
    io("rms_error_mm", ends(s.rms_error_mm), figure);
    io("largest_error_mm", ends(s.largest_error_mm), figure);
    io("along_rms_mm", ends(s.along_rms_mm), figure);
    io("along_max_mm", ends(s.along_max_mm), figure);
    io("across_rms_mm", ends(s.across_rms_mm), figure);
    io("across_max_mm", ends(s.across_max_mm), figure);
    io("lag_s", ends(s.lag_s), figure);
    io("rms_at_lag_mm", ends(s.rms_at_lag_mm), figure);
    io("rms_to_path_mm", ends(s.rms_to_path_mm), figure);
    io("speed_cv", ends(s.speed_cv), figure);
    io("intensity_cv", ends(s.intensity_cv), figure);
    io("felt_length_mm", ends(s.felt_length_mm), figure);
    io("length_ratio", ends(s.length_ratio), figure);
}

template <class Io>
void describe_error_members(Io& io, const prediction& r, observer_kind by)
{
    constexpr about error{"distance at equal times from the position felt to the target. This and all down "
                          "to rms_to_path_mm are null where nothing is felt, or nothing is predicted",
                          detail::from_0};
    constexpr about along{"part of that distance along the movement of the target; null also where the "
                          "target never moves",
                          detail::from_0};
    constexpr about across{"part of it across that movement, likewise", detail::from_0};
    const bool by_energy = by == observer_kind::centroid;
    const bool by_taps = has_taps(r, by);
    io.describe_or_null("rms_error_mm", r.felt.rms_error_mm, error);
    io.describe_or_null("largest_error_mm", r.felt.largest_error_mm, error);
    io.describe_or_null("along_rms_mm", r.felt.along_rms_mm, along);
    io.describe_or_null("along_max_mm", r.felt.along_max_mm, along);
    io.describe_or_null("across_rms_mm", r.felt.across_rms_mm, across);
    io.describe_or_null("across_max_mm", r.felt.across_max_mm, across);
    io.describe_or_null(
        "lag_s", r.felt.lag_s,
        {"how late the felt path is: the shift by which the RMS error gets least, in steps of 1 ms",
         {0.0, longest_lag_s}});
    io.describe_or_null("rms_at_lag_mm", r.felt.rms_at_lag_mm,
                        {"the RMS error with that shift", detail::from_0});
    io.describe_or_null("rms_to_path_mm", r.felt.rms_to_path_mm,
                        {"distance from the position felt to the nearest point of the path", detail::from_0});
    io.describe_or_null(
        "speed_cv", r.felt.speed_cv,
        {"standard deviation of speed by its mean; null where the stroke is too short for a speed. "
         "This and the next three are null with the observer low-speed",
         detail::from_0});
    io.describe_or_null("intensity_cv", r.felt.intensity_cv,
                        {"the same of intensity; null where nothing is felt", detail::from_0});
    io("silent_share", where(by_energy, r.felt.silent_share),
       {"part of the time in which no tactor sounds", detail::bounds_of::part});
    io("shared_share", where(by_energy, r.felt.shared_share),
       {"part of the time in which one tactor serves two bursts", detail::bounds_of::part});
    io.describe_or_null(
        "unpredicted", detail::omit_empty(r.unpredicted),
        {"why the observer low-speed has no prediction, as for continuous; null where it has. All "
         "down to taps is null where this is not, and with the observer centroid"});
    io("felt_length_mm", where(by_taps, r.tapped.felt_length_mm),
       {"length of the chain of the places at which the bursts are felt", detail::from_0});
    io("target_length_mm", where(by_taps, r.tapped.target_length_mm),
       {"the same of the target's places at their onsets", detail::from_0});
    io.describe_or_null("length_ratio", r.tapped.length_ratio,
                        {"the first divided by the second; null if the target rests", detail::from_0});
}

template <class Io>
void describe_result_members(Io& io, const comparison_row& r, observer_kind by)
{
    constexpr about names{"their names, as in tactor-plan/1"};
    const plan none;
    const plan& p = r.plan ? *r.plan : none;
    io("algorithm", r.algorithm, names);
    io("phantom", r.phantom, names);
    io("refused", where(r.refused.has_value(), std::string(r.refused ? r.refused->what() : "")),
       {"why it cannot play the stroke; null if it can. The following fields exist only if this is null"});
    io.describe_if_null("refused", !r.refused, [&](auto& rest) {
        rest("bursts", where(!p.curve, p.bursts.size()),
             {"number of bursts; null for the algorithm continuous"});
        rest.describe_or_null(
            "soa_s", p.soa_s,
            {"time from onset to onset; null if it differs between bursts", detail::above_0});
        rest("total_s", p.total_s, {"end of the last sound", detail::from_0});
        describe_error_members(rest, r, by);
        rest("taps", where(has_taps(r, by), r.taps), {"the bursts that are felt, by onset"});
        rest.describe_or_null(
            "spread", r.spread,
            {"null without {spread}, or without a prediction; else intervals, low and high"});
        rest("warnings", p.warnings, {"texts"});
    });
}

template <class Io>
void describe_comparison_members(Io& io, const comparison& c, const array& a)
{
    const bool by_taps = c.observer.kind == observer_kind::low_speed;
    const detail::observer_choice built_for{observer_kind::low_speed, c.observer.low_speed};
    io.constant("schema", "tactor-compare/1");
    io("note", detail::prediction_note(c.observer), {"what kind of figures these are"});
    io("observer", c.observer, {"the observer"});
    io("compensated_for", where(c.compensated, built_for),
       {"null, or the observer for which tactor moved the bursts, with {compensate}"});
    io("spread", where(c.spread.people != 0, drawn_people{c.spread, by_taps}),
       {"null, or the people drawn with {spread}"});
    io("faces", detail::omit_usual(c.faces, faces_kind::delaunay),
       {"nearest with {faces=nearest}; otherwise absent"});
    io.object("stroke", {"the stroke"}, [&](auto& inner) {
        inner("name", c.target.name, {"its name, or that of the file"});
        inner("duration_s", c.target.motion.duration_s(),
              {"time in which the target moves", detail::above_0});
        inner("length_mm", c.target.motion.length_mm(), {"length of its path", detail::from_0});
        inner("note", detail::omit_empty(note_text(c.target.note)),
              {"only for park2016-1 to -4: a note that they are reconstructed"});
    });
    io.object("array", {"the array"}, [&](auto& inner) {
        inner("name", a.name, {"name of the array"});
        inner.list("tactors", a.tactors, {"all of them, in order"},
                   [](auto& one, auto& t, std::size_t number) { describe_identity_members(one, t, number); });
    });
    io.list("results", c.rows, {"one for each algorithm with each phantom model"},
            [&](auto& inner, const comparison_row& r, std::size_t) {
                describe_result_members(inner, r, c.observer.kind);
            });
}

nlohmann::ordered_json errors_json(const prediction& r, observer_kind by)
{
    return make_object([&](auto& io) { describe_error_members(io, r, by); });
}

std::string comparisons_text(const std::vector<comparison>& all, const array& a)
{
    const auto whole = make_object([&](auto& io) {
        if (all.size() == 1)
            return describe_comparison_members(io, all[0], a);
        io.constant("schema", "tactor-compares/1");
        io.list("comparisons", all, {""}, [&a](auto& inner, const comparison& c, std::size_t) {
            describe_comparison_members(inner, c, a);
        });
    });
    return whole.dump(2) + '\n';
}

nlohmann::ordered_json comparison_schema()
{
    const comparison one;
    const array tactors;
    return json_schema::describe_object([&](auto& io) { describe_comparison_members(io, one, tactors); });
}

} // namespace tactor::files
