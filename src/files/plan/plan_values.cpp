// SPDX-License-Identifier: MIT
#include "files/plan/plan_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/kind_names.hpp"
#include "files/plan/plan_json.hpp"

namespace tactor::files {

namespace {

constexpr double most_amplitude = 1000.0; // as the intensity of a stroke

std::vector<drive> read_drives(const json_value& f)
{
    std::vector<drive> drives;
    for (const json_value& d : f["drives"].need_list()) {
        drives.push_back({d["tactor"].need_count(), d["amplitude"].need_number()});
        if (!(drives.back().amplitude >= 0.0 && drives.back().amplitude <= most_amplitude))
            d["amplitude"].refuse(
                fmt::format("is {}, not from 0 to {}", drives.back().amplitude, most_amplitude));
    }
    return drives;
}

// Refuses amplitudes above the intensity: a built-in model shares it out and adds nothing.
void check_amplitudes(const json_value& f, const std::string& name, const plan& p, const burst& b)
{
    constexpr double rounding = 1e-9;
    if (!detail::find_kind<phantom_kind>(p.phantom))
        return;
    for (const drive& d : b.drives)
        if (d.amplitude > b.intensity * (1.0 + rounding))
            f[name].refuse(fmt::format("drives tactor {} at {}, above its intensity of {}", d.tactor,
                                       d.amplitude, b.intensity));
}

// Drives and their order as planners make them.
void check_bursts(const json_value& f, const array& a, const plan& p, const std::vector<burst>& bursts)
{
    double latest = 0.0;
    for (std::size_t i = 0; i < bursts.size(); ++i) {
        const burst& b = bursts[i];
        const auto refuse = [&](const std::string& why) { f[fmt::format("bursts[{}]", i)].refuse(why); };
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

void check_samples(const json_value& f, const array& a, const plan& p, const curve_samples& samples)
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
            f["points"].refuse(fmt::format("drive tactor {} of {}", d.tactor, a.tactors.size()));
}

constexpr std::uint64_t most_way_points = 10000;

} // namespace

burst read_sample(const json_value& f)
{
    burst b;
    b.position = {f["x_mm"].need_number(), f["y_mm"].need_number()};
    b.intensity = f["intensity"].need_number();
    b.drives = read_drives(f);
    return b;
}

burst read_burst(const json_value& f)
{
    burst b = read_sample(f);
    b.onset_s = f["onset_s"].need_number();
    b.duration_s = f["duration_s"].need_number();
    b.tau_s = f["tau_s"].number();
    return b;
}

array read_array(const json_value& plan)
{
    const json_value f = plan["array"];
    array a;
    a.name = f["name"].need_text();
    for (const json_value& t : f["tactors"].need_list()) {
        tactor_spec s;
        s.position = {t["x_mm"].need_number(), t["y_mm"].need_number()};
        s.channel = t["channel"].need_count();
        s.polarity = t["polarity"].need_number() < 0.0 ? -1 : 1;
        s.gain_db = t["gain_db"].need_number();
        s.max_dbfs = t["max_dbfs"].need_number();
        take_threshold(t, s);
        s.rise_s = t["rise_s"].number();
        s.displacement_um_at_0dbfs = t["displacement_um_at_0dbfs"].number();
        a.tactors.push_back(s);
    }
    validate(a);
    return a;
}

render_options read_render(const json_value& plan)
{
    const json_value f = plan["render"];
    render_options o;
    o.rate = f["rate"].need_count();
    o.channels = f["channels"].need_count();
    o.phase = f["phase"].need_kind<phase_kind>();
    o.ramp_s = f["ramp_s"].need_member().number();
    o.sl_db = f["sl_db"].number();
    if (!o.sl_db)
        o.level_dbfs = f["level_dbfs"].need_number();
    o.envelope = read_envelope(f);
    if (f["marker"].need_member().there()) {
        const json_value marker = f["marker"];
        o.marker_channel = marker["channel"].need_count();
        o.marker_s = marker["duration_s"].need_number();
    }
    return o;
}

placed_plan read_plan(const json_value& f, const array& a, std::vector<burst> bursts, curve_samples samples,
                      recordings_kind recordings)
{
    plan p;
    const json_value drawn = f["stroke"];
    p.algorithm = f["algorithm"].need_text();
    p.phantom = f["phantom"].need_text();
    p.faces = f["faces"].kind<faces_kind>().value_or(p.faces);
    p.stroke_duration_s = drawn["duration_s"].need_number();
    p.stroke_length_mm = drawn["length_mm"].need_number();
    p.carrier_hz = drawn["carrier_hz"].need_number();
    take_sound(drawn, p, recordings);
    p.overlap = f["render"]["overlap"].need_kind<overlap_kind>();
    p.soa_s = f["soa_s"].need_member().number();
    p.total_s = f["total_s"].need_number();
    check_bursts(f, a, p, bursts);
    p.bursts = std::move(bursts);
    if (f["continuous"].there()) {
        if (f["continuous"]["step_s"].need_number() != continuous_step_s)
            f["continuous"]["step_s"].refuse(fmt::format("only {} s can be played", continuous_step_s));
        check_samples(f, a, p, samples);
        try {
            p.curve = curve(p.stroke_duration_s, std::move(samples));
        } catch (const error& e) {
            f["continuous"]["points"].refuse(fmt::format("{}: {}", e.why(), e.hint()));
        }
    }
    for (const json_value& c : f["conflicts"].need_list())
        p.conflicts.push_back({c["tactor"].need_count(), c["from_s"].need_number(), c["to_s"].need_number()});
    for (const conflict& c : p.conflicts)
        if (c.tactor >= a.tactors.size())
            f["conflicts"].refuse(fmt::format("have tactor {} of {}", c.tactor, a.tactors.size()));
    for (const json_value& m : f["dropped"].need_list())
        p.dropped.push_back({m["tau_s"].need_number(), {m["x_mm"].need_number(), m["y_mm"].need_number()}});
    for (const json_value& w : f["warnings"].need_list())
        p.warnings.push_back(w.need_text());
    const double start_s = f["start_s"].need_number();
    return {std::move(p), f["follows"].need_truth() ? std::nullopt : std::optional(start_s)};
}

std::optional<compensated_plan> read_compensation(const json_value& plan)
{
    if (!plan["compensation"].there())
        return {};
    const json_value f = plan["compensation"];
    compensated_plan c;
    c.observer = {f["sigma_mm"].need_number(), f["sigma_v_mm_s"].need_number()};
    c.at_edge = f["bursts_at_edge"].need_count();
    c.residual_rms_mm = f["residual_rms_mm"].need_number();
    c.residual_largest_mm = f["residual_largest_mm"].need_number();
    for (const json_value& t : f["taps"].need_list())
        c.taps.push_back({t["onset_s"].need_number(),
                          {t["target_x_mm"].need_number(), t["target_y_mm"].need_number()},
                          {t["alone_x_mm"].need_number(), t["alone_y_mm"].need_number()},
                          {t["felt_x_mm"].need_number(), t["felt_y_mm"].need_number()}});
    return c;
}

stroke read_stroke(const json_value& f, const plan& p, const std::optional<compensated_plan>& moved)
{
    const json_value drawn = f["stroke"];
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
    // For a picture: no more points than people can tell apart.
    const std::uint64_t step = p.curve ? 1 + p.curve->size() / most_way_points : 1;
    for (std::uint64_t k = 0; p.curve && k < p.curve->size(); k += step) {
        p.curve->sample(k, last);
        add(last.onset_s, last);
    }
    if (p.curve)
        p.curve->sample(p.curve->size() - 1, last);
    if (way.empty())
        f["bursts"].refuse("there are none");
    way.push_back({p.stroke_duration_s, last.position, last.intensity});
    stroke s{.name = drawn["name"].need_text()};
    // A level of its own takes a stroke above the others.
    const double most =
        std::max_element(way.begin(), way.end(), [](const timed_point& a, const timed_point& b) {
            return a.intensity < b.intensity;
        })->intensity;
    if (most > 1.0) {
        for (timed_point& q : way)
            q.intensity /= most;
        s.choices.level_db = 20.0 * std::log10(most);
    }
    s.motion = trajectory::timed(std::move(way));
    s.sound.carrier_hz = p.carrier_hz;
    s.sound.wave = p.wave;
    s.sound.am = p.am;
    const auto note = drawn["note"].text();
    for (const note_kind n : all_values<note_kind>())
        if (note == note_text(n))
            s.note = n;
    return s;
}

nlohmann::ordered_json fit_json(const fitting& f)
{
    const auto matrix = [&f](double a, double across, double d) {
        const point origin = f({0.0, 0.0});
        return nlohmann::ordered_json{{"margin_mm", f.margin_mm},
                                      {"matrix", {a, across, across, d, origin.x_mm, origin.y_mm}}};
    };
    if (!f.line)
        return matrix(f.scale, 0.0, f.scale);
    const auto [x, y] = *f.line;
    return matrix(f.scale * x * x, f.scale * x * y, f.scale * y * y);
}

std::optional<fitting> read_fitting(const json_value& plan)
{
    const json_value told = plan["stroke"]["fit"];
    if (!told.there())
        return {};
    const std::vector<double> m = told["matrix"].need_numbers();
    if (m.size() != 6)
        told["matrix"].refuse("has not six numbers");
    fitting f{.to = {m[4], m[5]}, .scale = m[0], .margin_mm = told["margin_mm"].need_number()};
    if (m[0] != m[3] || m[1] != 0.0) {
        f.scale = m[0] + m[3];
        f.line = {std::sqrt(m[0] / f.scale), std::copysign(std::sqrt(m[3] / f.scale), m[1])};
    }
    return f;
}

} // namespace tactor::files
