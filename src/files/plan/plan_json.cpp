// SPDX-License-Identifier: MIT
#include "files/plan/plan_json.hpp"

#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/plan/json_value.hpp"
#include "files/plan/plan_values.hpp"
#include "files/plan/row_json.hpp"

namespace tactor::files {
namespace {

using json = nlohmann::ordered_json;

// A plan of a record.
struct record {
    const stroke& drawn;
    const tactor::plan& plan;
    double start_s;
    bool follows; // the stroke before it, from the frame at which that ends
    std::uint64_t start_frame;
    const array& tactors;
    const score& samples; // of all plans
    const fitting* fit;
    const compensated_plan* moved; // null without compensation
    const render_options& options;
};

// Returns the peak of a tactor's channel at amplitude 1; null where a threshold is missing: nothing drives
// it.
json peak_dbfs(const tactor_spec& t, double carrier_hz, const render_options& o)
{
    if (!o.sl_db)
        return o.level_dbfs + t.gain_db;
    const auto threshold = threshold_at(t, carrier_hz);
    return threshold ? json(*threshold + *o.sl_db) : json(nullptr);
}

// Writes the options that turn the plan into samples.
json render_json(const record& r)
{
    const render_options& o = r.options;
    json j;
    j["rate"] = o.rate;
    j["channels"] = r.samples.channels();
    j["frames"] = r.samples.frames();
    j["phase"] = to_string(o.phase);
    j["ramp_s"] = or_null(o.ramp_s);
    if (o.sl_db)
        j["sl_db"] = *o.sl_db;
    else
        j["level_dbfs"] = o.level_dbfs;
    j["overlap"] = to_string(r.plan.overlap);
    j["peak_dbfs"] = json::array();
    for (const tactor_spec& t : r.tactors.tactors)
        j["peak_dbfs"].push_back(peak_dbfs(t, r.plan.carrier_hz, o));
    if (o.envelope != burst_envelope{})
        j["envelope"] = envelope_json(o.envelope);
    j["marker"] = nullptr;
    if (o.marker_channel)
        j["marker"] = {{"channel", *o.marker_channel}, {"duration_s", o.marker_s}};
    return j;
}

// Writes an object without its rows: they are streamed between head and tail.
json head_json(const record& r)
{
    const stroke& s = r.drawn;
    const plan& p = r.plan;
    json j;
    j["schema"] = "tactor-plan/1";
    j["algorithm"] = p.algorithm;
    j["phantom"] = p.phantom;
    if (p.faces != faces_kind::delaunay)
        j["faces"] = to_string(p.faces);
    j["start_s"] = r.start_s;
    j["start_frame"] = r.start_frame;
    j["follows"] = r.follows;
    j["stroke"] = {{"name", s.name},
                   {"duration_s", p.stroke_duration_s},
                   {"length_mm", p.stroke_length_mm},
                   {"carrier_hz", p.carrier_hz}};
    put_sound(j["stroke"], p);
    if (s.note != note_kind::none)
        j["stroke"]["note"] = note_text(s.note);
    if (r.fit)
        j["stroke"]["fit"] = fit_json(*r.fit);
    j["array"] = array_json(r.tactors);
    j["soa_s"] = or_null(p.soa_s);
    j["total_s"] = p.total_s;
    j["render"] = render_json(r);
    return j;
}

json compensation_json(const compensated_plan& c)
{
    const tap_summary felt = summarise(c.taps);
    json j = {{"observer", "low-speed"},
              {"sigma_mm", c.observer.sigma_mm},
              {"sigma_v_mm_s", c.observer.sigma_v_mm_s},
              {"built_for", "taps"},
              {"bursts_at_edge", c.at_edge},
              {"residual_rms_mm", c.residual_rms_mm},
              {"residual_largest_mm", c.residual_largest_mm},
              {"predicted_rms_mm", or_null(felt.rms_error_mm)},
              {"predicted_largest_mm", or_null(felt.largest_error_mm)}};
    j["taps"] = json::array();
    for (const tap& t : c.taps)
        j["taps"].push_back(tap_json(t));
    return j;
}

json tail_json(const record& r)
{
    const plan& p = r.plan;
    json j;
    if (r.moved != nullptr)
        j["compensation"] = compensation_json(*r.moved);
    j["conflicts"] = json::array();
    for (const conflict& c : p.conflicts)
        j["conflicts"].push_back({{"tactor", c.tactor}, {"from_s", c.from_s}, {"to_s", c.to_s}});
    j["dropped"] = json::array();
    for (const meeting& m : p.dropped)
        j["dropped"].push_back({{"tau_s", m.t_s}, {"x_mm", m.position.x_mm}, {"y_mm", m.position.y_mm}});
    j["warnings"] = p.warnings;
    return j;
}

// Writes a value on one line; file names may be no UTF-8.
std::string one_line(const json& j)
{
    return j.dump(-1, ' ', false, json::error_handler_t::replace);
}

// Returns the members of an object without its braces, so that objects can be joined.
std::string members(const json& j)
{
    const std::string text = one_line(j);
    return text.substr(1, text.size() - 2);
}

void write_plan(const text_sink& out, const record& r)
{
    const plan& p = r.plan;
    out(fmt::format("{{{},\n", members(head_json(r))));
    const bool sampled = p.curve.has_value();
    if (sampled)
        out(fmt::format("\"bursts\":[],\n\"continuous\":{{{},\"points\":[",
                        members({{"step_s", continuous_step_s},
                                 {"ramp_s", burst_ramp_s(0.0, p.stroke_duration_s, p, r.options)}})));
    else
        out("\"bursts\":[");
    row_json rows(r.tactors);
    std::string row = "\n  ";
    for_each_row(p, [&](const burst& b) {
        if (sampled)
            rows.append_sample(row, b);
        else
            rows.append(row, b, burst_ramp_s(b.onset_s, b.duration_s, p, r.options));
        out(row);
        row = ",\n  ";
    });
    out(fmt::format("]{},\n{}}}", sampled ? "}" : "", members(tail_json(r))));
}

} // namespace

json array_json(const array& a)
{
    json tactors = json::array();
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        tactors.push_back({{"tactor", i},
                           {"x_mm", t.position.x_mm},
                           {"y_mm", t.position.y_mm},
                           {"channel", t.channel},
                           {"polarity", t.polarity < 0 ? -1 : 1},
                           {"gain_db", t.gain_db},
                           {"max_dbfs", t.max_dbfs},
                           {"threshold_dbfs", threshold_json(t)}});
        if (t.rise_s)
            tactors.back()["rise_s"] = *t.rise_s;
        if (t.displacement_um_at_0dbfs)
            tactors.back()["displacement_um_at_0dbfs"] = *t.displacement_um_at_0dbfs;
    }
    return {{"name", a.name}, {"tactors", tactors}};
}

std::vector<double> piece::starts_s() const
{
    return start_times_s(plans);
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
        write_plan(out, {r.made.strokes[i], r.made.plans[i].plan, starts[i], !r.made.plans[i].start_s,
                         r.samples.starts()[i], r.tactors, r.samples, r.made.fit ? &*r.made.fit : nullptr,
                         r.made.moved.empty() ? nullptr : &r.made.moved[i], r.options});
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

} // namespace tactor::files
