// SPDX-License-Identifier: MIT
#include "files/plan/plan_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/kind_names.hpp"
#include "files/plan/plan_json.hpp"
#include "files/plan/plan_sound.hpp"

namespace tactor::files {
namespace {

constexpr double most_amplitude = 1000.0; // as the intensity of a stroke

std::vector<drive> read_drives(const fields& f)
{
    std::vector<drive> drives;
    for (const fields& d : f.list("drives")) {
        drives.push_back({d.count("tactor"), d.number("amplitude")});
        if (!(drives.back().amplitude >= 0.0 && drives.back().amplitude <= most_amplitude))
            d.refuse("amplitude",
                     fmt::format("is {}, not from 0 to {}", drives.back().amplitude, most_amplitude));
    }
    return drives;
}

burst read_place(const fields& f)
{
    burst b;
    b.position = {f.number("x_mm"), f.number("y_mm")};
    b.intensity = f.number("intensity");
    b.drives = read_drives(f);
    return b;
}

// A built-in model shares the intensity out and adds nothing to it.
void check_amplitudes(const fields& f, const std::string& name, const plan& p, const burst& b)
{
    constexpr double rounding = 1e-9;
    if (!detail::kind_named<phantom_kind>(p.phantom))
        return;
    for (const drive& d : b.drives)
        if (d.amplitude > b.intensity * (1.0 + rounding))
            f.refuse(name.c_str(), fmt::format("drives tactor {} at {}, above its intensity of {}", d.tactor,
                                               d.amplitude, b.intensity));
}

// Drives and their order as planners make them.
void check_bursts(const fields& f, const array& a, const plan& p, const std::vector<burst>& bursts)
{
    double latest = 0.0;
    for (std::size_t i = 0; i < bursts.size(); ++i) {
        const burst& b = bursts[i];
        const auto refuse = [&](const std::string& why) {
            f.refuse(fmt::format("bursts[{}]", i).c_str(), why);
        };
        if (b.onset_s < latest)
            refuse("begins before the one before it");
        latest = b.onset_s;
        for (std::size_t k = 0; k < b.drives.size(); ++k) {
            if (b.drives[k].tactor >= a.tactors.size())
                refuse(fmt::format("drives tactor {} of {}", b.drives[k].tactor, a.tactors.size()));
            if (k > 0 && b.drives[k].tactor <= b.drives[k - 1].tactor)
                refuse("its drives are not in order of tactor");
        }
        check_amplitudes(f, fmt::format("bursts[{}]", i), p, b);
    }
}

void check_samples(const fields& f, const array& a, const plan& p, const curve_samples& samples)
{
    burst b;
    for (std::size_t i = 0; i < samples.ends.size(); ++i) {
        const drive* const first = samples.drives.data() + (i == 0 ? 0 : samples.ends[i - 1]);
        b.intensity = samples.intensities[i];
        b.drives.assign(first, samples.drives.data() + samples.ends[i]);
        check_amplitudes(f, fmt::format("points[{}]", i), p, b);
    }
    for (const drive& d : samples.drives)
        if (d.tactor >= a.tactors.size())
            f.refuse("points", fmt::format("drive tactor {} of {}", d.tactor, a.tactors.size()));
}

constexpr std::uint64_t most_way_points = 10000;

} // namespace

void fields::refuse(const char* name, const std::string& why) const
{
    const std::string where = place_.empty() ? name : fmt::format("{}.{}", place_, name);
    throw error(error_kind::bad_input, fmt::format("{}: {}", file_, where), why, "see tactor-json(5)")
        .with_field(where)
        .with_place({file_});
}

const nlohmann::json& fields::member(const char* name) const
{
    const auto it = object_.find(name);
    if (it == object_.end())
        refuse(name, "is missing");
    return *it;
}

bool fields::has(const char* name) const
{
    return object_.contains(name);
}

bool fields::is_null(const char* name) const
{
    return member(name).is_null();
}

double fields::number(const char* name) const
{
    const nlohmann::json& j = member(name);
    if (!j.is_number() || !std::isfinite(j.get<double>()))
        refuse(name, "is no number");
    return j.get<double>();
}

std::optional<double> fields::number_or_null(const char* name) const
{
    return member(name).is_null() ? std::nullopt : std::optional(number(name));
}

unsigned fields::count(const char* name) const
{
    const nlohmann::json& j = member(name);
    if (!j.is_number_unsigned() || j.get<std::uint64_t>() > 1'000'000)
        refuse(name, "is no whole number from 0 to 1000000");
    return j.get<unsigned>();
}

std::string fields::text(const char* name) const
{
    const nlohmann::json& j = member(name);
    if (!j.is_string())
        refuse(name, "is no text");
    return j.get<std::string>();
}

bool fields::flag(const char* name) const
{
    const nlohmann::json& j = member(name);
    if (!j.is_boolean())
        refuse(name, "is neither true nor false");
    return j.get<bool>();
}

fields fields::object(const char* name) const
{
    const nlohmann::json& j = member(name);
    if (!j.is_object())
        refuse(name, "is no object");
    return {file_, place_.empty() ? name : fmt::format("{}.{}", place_, name), j};
}

std::vector<fields> fields::list(const char* name) const
{
    const nlohmann::json& j = member(name);
    if (!j.is_array())
        refuse(name, "is no list");
    std::vector<fields> all;
    for (std::size_t i = 0; i < j.size(); ++i) {
        const std::string place = fmt::format("{}{}{}[{}]", place_, place_.empty() ? "" : ".", name, i);
        if (!j[i].is_object())
            refuse(name, "has a member that is no object");
        all.emplace_back(file_, place, j[i]);
    }
    return all;
}

bool fields::is_list(const char* name) const
{
    return member(name).is_array();
}

std::vector<std::pair<double, double>> fields::pairs(const char* name) const
{
    std::vector<std::pair<double, double>> all;
    for (const nlohmann::json& p : member(name)) {
        if (!p.is_array() || p.size() != 2 || !p[0].is_number() || !p[1].is_number())
            refuse(name, "is no list of pairs of numbers");
        all.emplace_back(p[0].get<double>(), p[1].get<double>());
    }
    return all;
}

std::vector<double> fields::numbers(const char* name) const
{
    const nlohmann::json& j = member(name);
    const auto is_number = [](const nlohmann::json& n) { return n.is_number(); };
    if (!j.is_array() || !std::all_of(j.begin(), j.end(), is_number))
        refuse(name, "is no list of numbers");
    return j.get<std::vector<double>>();
}

std::vector<std::string> fields::texts(const char* name) const
{
    const nlohmann::json& j = member(name);
    const auto is_text = [](const nlohmann::json& t) { return t.is_string(); };
    if (!j.is_array() || !std::all_of(j.begin(), j.end(), is_text))
        refuse(name, "is no list of texts");
    return j.get<std::vector<std::string>>();
}

burst read_burst(const fields& f)
{
    burst b = read_place(f);
    b.onset_s = f.number("onset_s");
    b.duration_s = f.number("duration_s");
    if (f.has("tau_s"))
        b.tau_s = f.number("tau_s");
    return b;
}

burst read_sample(const fields& f)
{
    return read_place(f);
}

array read_array(const fields& plan)
{
    const fields f = plan.object("array");
    array a;
    a.name = f.text("name");
    for (const fields& t : f.list("tactors")) {
        tactor_spec s;
        s.position = {t.number("x_mm"), t.number("y_mm")};
        s.channel = t.count("channel");
        s.polarity = t.number("polarity") < 0.0 ? -1 : 1;
        s.gain_db = t.number("gain_db");
        s.max_dbfs = t.number("max_dbfs");
        take_threshold(t, s);
        if (t.has("rise_s"))
            s.rise_s = t.number("rise_s");
        a.tactors.push_back(s);
    }
    validate(a);
    return a;
}

render_options read_render(const fields& plan)
{
    const fields f = plan.object("render");
    render_options o;
    o.rate = f.count("rate");
    o.channels = f.count("channels");
    o.phase = f.kind<phase_kind>("phase");
    o.ramp_s = f.number_or_null("ramp_s");
    if (f.has("sl_db"))
        o.sl_db = f.number("sl_db");
    else
        o.level_dbfs = f.number("level_dbfs");
    o.envelope = read_envelope(f);
    if (!f.is_null("marker")) {
        const fields marker = f.object("marker");
        o.marker_channel = marker.count("channel");
        o.marker_s = marker.number("duration_s");
    }
    return o;
}

placed_plan read_plan(const fields& f, const array& a, std::vector<burst> bursts, curve_samples samples)
{
    plan p;
    const fields drawn = f.object("stroke");
    p.algorithm = f.text("algorithm");
    p.phantom = f.text("phantom");
    if (f.has("faces"))
        p.faces = f.kind<faces_kind>("faces");
    p.stroke_duration_s = drawn.number("duration_s");
    p.stroke_length_mm = drawn.number("length_mm");
    p.carrier_hz = drawn.number("carrier_hz");
    take_sound(drawn, p);
    p.overlap = f.object("render").kind<overlap_kind>("overlap");
    p.soa_s = f.number_or_null("soa_s");
    p.total_s = f.number("total_s");
    check_bursts(f, a, p, bursts);
    p.bursts = std::move(bursts);
    if (f.has("continuous")) {
        if (f.object("continuous").number("step_s") != continuous_step_s)
            f.refuse("continuous.step_s", fmt::format("only {} s can be played", continuous_step_s));
        check_samples(f, a, p, samples);
        try {
            p.curve = curve(p.stroke_duration_s, std::move(samples));
        } catch (const error& e) {
            f.refuse("continuous.points", fmt::format("{}: {}", e.why(), e.hint()));
        }
    }
    for (const fields& c : f.list("conflicts"))
        p.conflicts.push_back({c.count("tactor"), c.number("from_s"), c.number("to_s")});
    for (const conflict& c : p.conflicts)
        if (c.tactor >= a.tactors.size())
            f.refuse("conflicts", fmt::format("have tactor {} of {}", c.tactor, a.tactors.size()));
    for (const fields& m : f.list("dropped"))
        p.dropped.push_back({m.number("tau_s"), {m.number("x_mm"), m.number("y_mm")}});
    p.warnings = f.texts("warnings");
    const double start_s = f.number("start_s");
    return {std::move(p), f.flag("follows") ? std::nullopt : std::optional(start_s)};
}

std::optional<compensated_plan> read_compensation(const fields& plan)
{
    if (!plan.has("compensation"))
        return {};
    const fields f = plan.object("compensation");
    compensated_plan c;
    c.observer = {f.number("sigma_mm"), f.number("sigma_v_mm_s")};
    c.at_edge = f.count("bursts_at_edge");
    c.residual_rms_mm = f.number("residual_rms_mm");
    c.residual_largest_mm = f.number("residual_largest_mm");
    for (const fields& t : f.list("taps"))
        c.taps.push_back({t.number("onset_s"),
                          {t.number("target_x_mm"), t.number("target_y_mm")},
                          {t.number("alone_x_mm"), t.number("alone_y_mm")},
                          {t.number("felt_x_mm"), t.number("felt_y_mm")}});
    return c;
}

stroke read_stroke(const fields& f, const plan& p, const std::optional<compensated_plan>& moved)
{
    const fields drawn = f.object("stroke");
    std::vector<timed_point> way;
    const auto add = [&](double t_s, const burst& b) {
        if (way.empty())
            way.push_back({0.0, b.position, b.intensity});
        else if (t_s > way.back().t_s && t_s < p.stroke_duration_s)
            way.push_back({t_s, b.position, b.intensity});
    };
    burst last;
    const bool elsewhere = moved && !moved->taps.empty(); // silent bursts are where they were asked for
    for (const tap& t : elsewhere ? moved->taps : std::vector<tap>{}) {
        last.position = t.target;
        add(t.onset_s, last);
    }
    for (const burst& b : elsewhere ? std::vector<burst>{} : p.bursts) {
        add(b.tau_s.value_or(b.onset_s), b);
        last = b;
    }
    // For a picture; as many as one can tell apart.
    const std::uint64_t step = p.curve ? 1 + p.curve->size() / most_way_points : 1;
    for (std::uint64_t k = 0; p.curve && k < p.curve->size(); k += step) {
        p.curve->sample(k, last);
        add(last.onset_s, last);
    }
    if (p.curve)
        p.curve->sample(p.curve->size() - 1, last);
    if (way.empty())
        f.refuse("bursts", "there are none");
    way.push_back({p.stroke_duration_s, last.position, last.intensity});
    stroke s{drawn.text("name"), trajectory::timed(std::move(way))};
    s.carrier_hz = p.carrier_hz;
    s.wave = p.wave;
    s.am = p.am;
    if (drawn.has("note")) {
        const std::string note = drawn.text("note");
        for (const note_kind n : values_of<note_kind>())
            if (note == note_text(n))
                s.note = n;
    }
    return s;
}

} // namespace tactor::files
