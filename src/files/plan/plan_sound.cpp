// SPDX-License-Identifier: MIT
#include "files/plan/plan_sound.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "files/plan/json_values.hpp"

namespace tactor::files {
namespace {

using json = nlohmann::ordered_json;

constexpr double most_bend_hz = 1e7;

// Whoever plays the plan may be elsewhere.
std::string name_waveform(const waveform& w)
{
    std::string text = waveform_text(w);
    if (w.kind != waveform_kind::recording)
        return text;
    std::error_code nowhere;
    const std::filesystem::path whole = std::filesystem::absolute(text, nowhere);
    return nowhere ? text : whole.string();
}

void take_bend(const fields& c, carrier_point& into)
{
    const std::vector<double> bend = c.numbers("bend");
    if (bend.size() != into.bend.size() ||
        std::any_of(bend.begin(), bend.end(), [](double v) { return !(std::abs(v) <= most_bend_hz); }))
        c.refuse("bend", "is not four numbers of at most 1e7 Hz");
    std::copy(bend.begin(), bend.end(), into.bend.begin());
}

} // namespace

void put_sound(nlohmann::ordered_json& stroke, const plan& p)
{
    const waveform& w = p.wave;
    if (w.kind != waveform_kind::sine)
        stroke["waveform"] = name_waveform(w);
    if (w.kind == waveform_kind::noise)
        stroke["noise_seed"] = w.seed;
    if (w.kind == waveform_kind::recording) {
        stroke["recording"] = {{"file", name_waveform(w)},
                               {"sha256", w.recorded->sha256},
                               {"frames", w.recorded->samples.size()},
                               {"rate", w.recorded->rate_hz}};
        stroke["texture"] = to_string(w.texture);
        if (w.texture == texture_kind::length)
            stroke["texture_mm"] = w.texture_mm;
    }
    if (p.am.hz > 0.0) {
        stroke["am_hz"] = p.am.hz;
        stroke["am_depth"] = p.am.depth;
    }
    if (p.course.empty())
        return;
    stroke["course"] = json::array();
    for (const carrier_point& c : p.course) {
        stroke["course"].push_back({{"t_s", c.t_s}, {"hz", c.hz}});
        if (c.bend != carrier_point{}.bend)
            stroke["course"].back()["bend"] = c.bend;
    }
}

nlohmann::ordered_json envelope_json(const burst_envelope& e)
{
    json j = {{"kind", to_string(e.kind)}, {"tukey_part", e.tukey_part}};
    j["attack_s"] = or_null(e.attack_s);
    j["release_s"] = or_null(e.release_s);
    return j;
}

nlohmann::ordered_json threshold_json(const tactor_spec& t)
{
    if (t.thresholds.empty())
        return or_null(t.threshold_dbfs);
    json all = json::array();
    for (const threshold_point& p : t.thresholds)
        all.push_back({p.hz, p.dbfs});
    return all;
}

void take_threshold(const fields& t, tactor_spec& into)
{
    if (!t.is_list("threshold_dbfs")) {
        into.threshold_dbfs = t.number_or_null("threshold_dbfs");
        return;
    }
    for (const auto& [hz, dbfs] : t.pairs("threshold_dbfs"))
        into.thresholds.push_back({hz, dbfs});
}

namespace {

// Other samples would sound under the plan's name.
void check_recording(const fields& said, const recording& r)
{
    if (said.text("sha256") != r.sha256 || said.number("frames") != static_cast<double>(r.samples.size()) ||
        said.number("rate") != r.rate_hz)
        throw error(error_kind::bad_input, source_place{r.file},
                    "the recording has changed since the plan was made",
                    "plan the stroke again, or bring the old file back");
}

} // namespace

void take_sound(const fields& stroke, plan& p)
{
    try {
        if (stroke.has("waveform"))
            p.wave = parse_waveform(stroke.text("waveform"));
    } catch (const error& e) {
        stroke.refuse("waveform", fmt::format("{}: {}", e.subject(), e.why()));
    }
    if (p.wave.recorded && stroke.has("recording"))
        check_recording(stroke.object("recording"), *p.wave.recorded);
    if (stroke.has("noise_seed")) {
        const double seed = stroke.number("noise_seed");
        if (!(seed >= 0.0 && seed <= 0x1p53 && seed == std::floor(seed)))
            stroke.refuse("noise_seed", "is no whole number from 0 to 2^53");
        p.wave.seed = static_cast<std::uint64_t>(seed);
    }
    if (stroke.has("texture"))
        p.wave.texture = stroke.kind<texture_kind>("texture");
    if (stroke.has("texture_mm"))
        p.wave.texture_mm = stroke.number("texture_mm");
    if (stroke.has("am_hz"))
        p.am = {stroke.number("am_hz"), stroke.number("am_depth")};
    if (!stroke.has("course"))
        return;
    for (const fields& c : stroke.list("course")) {
        carrier_point next{c.number("t_s"), c.number("hz")};
        if (c.has("bend"))
            take_bend(c, next);
        const bool ascends = p.course.empty() ? next.t_s >= 0.0 : next.t_s >= p.course.back().t_s;
        if (!ascends || !(next.hz >= 0.0 && next.hz <= 384000.0))
            stroke.refuse("course", "has a point out of order, or with no frequency");
        p.course.push_back(next);
    }
}

burst_envelope read_envelope(const fields& render)
{
    burst_envelope e;
    if (!render.has("envelope"))
        return e;
    const fields f = render.object("envelope");
    e.kind = f.kind<envelope_kind>("kind");
    e.attack_s = f.number_or_null("attack_s");
    e.release_s = f.number_or_null("release_s");
    e.tukey_part = f.number("tukey_part");
    return e;
}

} // namespace tactor::files
