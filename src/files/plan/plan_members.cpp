// SPDX-License-Identifier: MIT
#include "files/plan/plan_members.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>

#include <fmt/format.h>

namespace tactor::files {
namespace {

// Names a file by its whole path: the plan may be played in another folder.
std::string name_waveform(const waveform& w)
{
    std::string text = waveform_text(w);
    if (w.kind != waveform_kind::recording)
        return text;
    std::error_code nowhere;
    const std::filesystem::path whole = std::filesystem::absolute(text, nowhere);
    return nowhere ? text : whole.string();
}

bool is_same(const recording_facts& f, const recording& r)
{
    return f.sha256 == r.sha256 && f.frames == r.samples.size() && f.rate == r.rate_hz;
}

// Returns the recording if it lies beside the plan, where both may have been moved.
std::optional<waveform> find_beside(const std::string& file, const plan_sound& s)
{
    namespace fs = std::filesystem;
    const fs::path beside = fs::path(file).parent_path() / fs::path(*s.waveform).filename();
    std::error_code unknown;
    if (!s.recording || !fs::is_regular_file(beside, unknown))
        return {};
    try {
        waveform w;
        w.kind = waveform_kind::recording;
        w.recorded = std::make_shared<const recording>(load_recording(beside));
        return is_same(*s.recording, *w.recorded) ? std::optional(w) : std::nullopt;
    } catch (const error&) { // another file of that name
        return {};
    }
}

// Refuses a recording that has changed: other samples would sound under the plan's name.
void check_recording(const recording_facts& f, const recording& r)
{
    if (!is_same(f, r))
        throw error(error_kind::bad_input, source_place{r.file},
                    "the recording has changed since the plan was made",
                    "plan the stroke again, or bring the old file back");
}

// Reads the waveform, from its file or the one beside the plan.
waveform read_waveform(const plan_sound& s, const json_value& stroke, recordings_kind recordings)
{
    if (recordings == recordings_kind::refuse && waveform_names_file(*s.waveform))
        stroke["waveform"].refuse(fmt::format("is a file, {}, and this text is none", *s.waveform));
    const auto found = find_beside(stroke.file(), s);
    try {
        return found ? *found : parse_waveform(*s.waveform);
    } catch (const error& e) {
        stroke["waveform"].refuse(fmt::format("{}: {}", e.subject(), e.why()));
    }
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

std::vector<std::optional<double>> list_peaks_dbfs(const array& a, double carrier_hz, const render_options& o)
{
    std::vector<std::optional<double>> all;
    for (const tactor_spec& t : a.tactors) {
        all.emplace_back(o.level_dbfs + t.gain_db);
        if (!o.sl_db)
            continue;
        const auto threshold = threshold_at(t, carrier_hz);
        all.back() = threshold ? std::optional(*threshold + *o.sl_db) : std::nullopt;
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

fitting make_fitting(const fit_matrix& given)
{
    const auto& m = given.matrix;
    fitting f{.to = {m[4], m[5]}, .scale = m[0], .margin_mm = given.margin_mm};
    if (m[0] != m[3] || m[1] != 0.0) {
        f.scale = m[0] + m[3];
        f.line = {std::sqrt(m[0] / f.scale), std::copysign(std::sqrt(m[3] / f.scale), m[1])};
    }
    return f;
}

std::string note_text(note_kind n)
{
    switch (n) {
    case note_kind::none:
        break;
    case note_kind::reconstructed:
        return "reconstructed: the figure that shows it is not in the paper's text";
    }
    return "";
}

plan_sound record_sound(const plan& p)
{
    const waveform& w = p.wave;
    plan_sound s;
    if (w.kind != waveform_kind::sine)
        s.waveform = name_waveform(w);
    if (w.kind == waveform_kind::noise)
        s.noise_seed = w.seed;
    if (w.kind == waveform_kind::recording) {
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

void set_sound(plan& p, const plan_sound& s, const json_value& stroke, recordings_kind recordings)
{
    if (s.waveform)
        p.wave = read_waveform(s, stroke, recordings);
    if (p.wave.recorded && s.recording)
        check_recording(*s.recording, *p.wave.recorded);
    p.wave.seed = s.noise_seed.value_or(p.wave.seed);
    p.wave.texture = s.texture.value_or(p.wave.texture);
    p.wave.texture_mm = s.texture_mm.value_or(p.wave.texture_mm);
    if (s.am_hz.has_value() != s.am_depth.has_value())
        stroke["am_hz"].refuse("goes with am_depth");
    if (s.am_hz)
        p.am = {*s.am_hz, *s.am_depth};
    p.course = s.course.value_or(p.course);
    for (std::size_t i = 1; i < p.course.size(); ++i)
        if (p.course[i].t_s < p.course[i - 1].t_s)
            stroke["course"].refuse("has a point out of order");
}

} // namespace tactor::files
