// SPDX-License-Identifier: MIT
#include "files/plan/plan_values.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "files/plan/json_value.hpp"

namespace tactor::files {
namespace {

using json = nlohmann::ordered_json;

constexpr double most_bend_hz = 1e7;

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

void take_bend(const json_value& c, carrier_point& into)
{
    const std::vector<double> bend = c["bend"].need_numbers();
    if (bend.size() != into.bend.size() ||
        std::any_of(bend.begin(), bend.end(), [](double v) { return !(std::abs(v) <= most_bend_hz); }))
        c["bend"].refuse("is not four numbers of at most 1e7 Hz");
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

void take_threshold(const json_value& t, tactor_spec& into)
{
    const json_value one_or_more = t["threshold_dbfs"].need_member();
    if (!one_or_more.is_list()) {
        into.threshold_dbfs = one_or_more.number();
        return;
    }
    for (const json_value& pair : one_or_more.list()) {
        const std::vector<double> hz_and_dbfs = pair.need_numbers();
        if (hz_and_dbfs.size() != 2)
            pair.refuse("is no pair of numbers");
        into.thresholds.push_back({hz_and_dbfs[0], hz_and_dbfs[1]});
    }
}

namespace {

bool is_same(const json_value& said, const recording& r)
{
    return said["sha256"].need_text() == r.sha256 &&
           said["frames"].need_number() == static_cast<double>(r.samples.size()) &&
           said["rate"].need_number() == r.rate_hz;
}

// Returns the recording if it lies beside the plan, where both may have been moved.
std::optional<waveform> find_beside(const json_value& stroke, const std::string& text)
{
    namespace fs = std::filesystem;
    const fs::path beside = fs::path(stroke.file()).parent_path() / fs::path(text).filename();
    std::error_code unknown;
    if (!stroke["recording"].there() || !fs::is_regular_file(beside, unknown))
        return {};
    try {
        waveform w;
        w.kind = waveform_kind::recording;
        w.recorded = std::make_shared<const recording>(load_recording(beside));
        return is_same(stroke["recording"], *w.recorded) ? std::optional(w) : std::nullopt;
    } catch (const error&) { // another file of that name
        return {};
    }
}

// Refuses a recording that has changed: other samples would sound under the plan's name.
void check_recording(const json_value& said, const recording& r)
{
    if (!is_same(said, r))
        throw error(error_kind::bad_input, source_place{r.file},
                    "the recording has changed since the plan was made",
                    "plan the stroke again, or bring the old file back");
}

} // namespace

void take_sound(const json_value& stroke, plan& p, recordings_kind recordings)
{
    const auto text = stroke["waveform"].text();
    if (text && recordings == recordings_kind::refuse && waveform_names_file(*text))
        stroke["waveform"].refuse(fmt::format("is a file, {}, and this text is none", *text));
    const auto found = text ? find_beside(stroke, *text) : std::nullopt;
    try {
        if (text)
            p.wave = found ? *found : parse_waveform(*text);
    } catch (const error& e) {
        stroke["waveform"].refuse(fmt::format("{}: {}", e.subject(), e.why()));
    }
    if (p.wave.recorded && stroke["recording"].there())
        check_recording(stroke["recording"], *p.wave.recorded);
    if (const auto seed = stroke["noise_seed"].number()) {
        if (!detail::bounds_of::seed.holds(*seed) || *seed != std::floor(*seed))
            stroke["noise_seed"].refuse("is no whole number from 0 to 2^53");
        p.wave.seed = static_cast<std::uint64_t>(*seed);
    }
    p.wave.texture = stroke["texture"].kind<texture_kind>().value_or(p.wave.texture);
    p.wave.texture_mm = stroke["texture_mm"].number().value_or(p.wave.texture_mm);
    if (stroke["am_hz"].there())
        p.am = {stroke["am_hz"].need_number(), stroke["am_depth"].need_number()};
    for (const json_value& c : stroke["course"].list()) {
        carrier_point next{c["t_s"].need_number(), c["hz"].need_number()};
        if (c["bend"].there())
            take_bend(c, next);
        const bool ascends = p.course.empty() ? next.t_s >= 0.0 : next.t_s >= p.course.back().t_s;
        if (!ascends || !(next.hz >= 0.0 && next.hz <= detail::bounds_of::carrier_hz.high))
            stroke["course"].refuse("has a point out of order, or with no frequency");
        p.course.push_back(next);
    }
}

burst_envelope read_envelope(const json_value& render)
{
    burst_envelope e;
    if (!render["envelope"].there())
        return e;
    const json_value f = render["envelope"];
    e.kind = f["kind"].need_kind<envelope_kind>();
    e.attack_s = f["attack_s"].need_member().number();
    e.release_s = f["release_s"].need_member().number();
    e.tukey_part = f["tukey_part"].need_number();
    return e;
}

} // namespace tactor::files
