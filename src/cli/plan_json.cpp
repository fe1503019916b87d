// SPDX-License-Identifier: MIT
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/plan_output.hpp"
#include "cli/plan_rows.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

// One stroke of a piece, and all that its samples depend on.
struct record {
    const stroke& drawn;
    const plan& schedule;
    double start_s;
    std::uint64_t start_frame;
    const array& tactors;
    const score& samples; // of the whole piece
    const std::optional<fitting>& fit;
    const render_options& options;
};

json drives_json(const std::vector<drive>& drives, const array& a)
{
    json list = json::array();
    for (const drive& d : drives)
        list.push_back(
            {{"tactor", d.tactor}, {"channel", a.tactors[d.tactor].channel}, {"amplitude", d.amplitude}});
    return list;
}

json burst_json(const burst& b, const record& r, bool sampled)
{
    json j;
    if (sampled) {
        j["t_s"] = b.onset_s;
    } else {
        j["onset_s"] = b.onset_s;
        j["duration_s"] = b.duration_s;
        j["ramp_s"] = burst_ramp_s(b.onset_s, b.duration_s, r.schedule.carrier_hz, r.options);
    }
    if (b.tau_s)
        j["tau_s"] = *b.tau_s;
    j["x_mm"] = b.position.x_mm;
    j["y_mm"] = b.position.y_mm;
    j["intensity"] = b.intensity;
    j["drives"] = drives_json(b.drives, r.tactors);
    return j;
}

json array_json(const array& a)
{
    json tactors = json::array();
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        tactors.push_back({{"tactor", i},
                           {"x_mm", t.position.x_mm},
                           {"y_mm", t.position.y_mm},
                           {"channel", t.channel},
                           {"polarity", t.polarity < 0 ? -1 : 1}});
    }
    return {{"name", a.name}, {"tactors", tactors}};
}

// The peak of a tactor's channel at amplitude 1.
double peak_dbfs(const tactor_spec& t, const render_options& o)
{
    return o.sl_db ? t.threshold_dbfs.value() + *o.sl_db : o.level_dbfs + t.gain_db;
}

// What turns the plan into samples.
json render_json(const record& r)
{
    const render_options& o = r.options;
    json j;
    j["rate"] = o.rate;
    j["channels"] = r.samples.channels();
    j["frames"] = r.samples.frames();
    j["phase"] = to_string(o.phase);
    j["ramp_s"] = o.ramp_s ? json(*o.ramp_s) : json(nullptr);
    if (o.sl_db)
        j["sl_db"] = *o.sl_db;
    else
        j["level_dbfs"] = o.level_dbfs;
    j["overlap"] = to_string(r.schedule.join);
    j["peak_dbfs"] = json::array();
    for (const tactor_spec& t : r.tactors.tactors)
        j["peak_dbfs"].push_back(peak_dbfs(t, o));
    j["marker"] = nullptr;
    if (o.marker_channel)
        j["marker"] = {{"channel", *o.marker_channel}, {"duration_s", o.marker_s}};
    return j;
}

// x' = a x + c y + e, y' = b x + d y + f, as in SVG.
json fit_json(const fitting& f)
{
    const point origin = f({0.0, 0.0});
    const point x = f({f.from.x_mm + 1.0, f.from.y_mm});
    const point y = f({f.from.x_mm, f.from.y_mm + 1.0});
    return {{"margin_mm", f.margin_mm},
            {"matrix",
             {x.x_mm - f.to.x_mm, x.y_mm - f.to.y_mm, y.x_mm - f.to.x_mm, y.y_mm - f.to.y_mm, origin.x_mm,
              origin.y_mm}}};
}

// One object without its rows: they are streamed between head and tail.
json head_json(const record& r)
{
    const stroke& s = r.drawn;
    const plan& p = r.schedule;
    json j;
    j["schema"] = "tactor-plan/1";
    j["algorithm"] = p.algorithm;
    j["phantom"] = p.phantom;
    j["start_s"] = r.start_s;
    j["start_frame"] = r.start_frame;
    j["stroke"] = {{"name", s.name},
                   {"duration_s", p.stroke_duration_s},
                   {"length_mm", p.stroke_length_mm},
                   {"carrier_hz", p.carrier_hz}};
    if (!s.note.empty())
        j["stroke"]["note"] = s.note;
    if (r.fit)
        j["stroke"]["fit"] = fit_json(*r.fit);
    j["array"] = array_json(r.tactors);
    j["soa_s"] = p.soa_s ? json(*p.soa_s) : json(nullptr);
    j["total_s"] = p.total_s;
    j["render"] = render_json(r);
    return j;
}

json tail_json(const plan& p)
{
    json j;
    j["conflicts"] = json::array();
    for (const conflict& c : p.conflicts)
        j["conflicts"].push_back({{"tactor", c.tactor}, {"from_s", c.from_s}, {"to_s", c.to_s}});
    j["dropped"] = json::array();
    for (const meeting& m : p.dropped)
        j["dropped"].push_back({{"tau_s", m.t_s}, {"x_mm", m.position.x_mm}, {"y_mm", m.position.y_mm}});
    j["warnings"] = p.warnings;
    return j;
}

// On one line; file names may be no UTF-8.
std::string one_line(const json& j)
{
    return j.dump(-1, ' ', false, json::error_handler_t::replace);
}

// The members of an object without its braces, so that objects can be joined.
std::string members(const json& j)
{
    const std::string text = one_line(j);
    return text.substr(1, text.size() - 2);
}

void print_plan(std::FILE* out, const record& r)
{
    const plan& p = r.schedule;
    fmt::print(out, "{{{},\n", members(head_json(r)));
    const bool sampled = static_cast<bool>(p.at);
    if (sampled)
        fmt::print(out, "\"bursts\":[],\n\"continuous\":{{{},\"points\":[",
                   members({{"step_s", continuous_step_s},
                            {"ramp_s", burst_ramp_s(0.0, p.stroke_duration_s, p.carrier_hz, r.options)}}));
    else
        fmt::print(out, "\"bursts\":[");
    const char* separator = "\n  ";
    for_each_row(p, [&](const burst& b) {
        fmt::print(out, "{}{}", separator, one_line(burst_json(b, r, sampled)));
        separator = ",\n  ";
    });
    fmt::print(out, "]{},\n{}}}", sampled ? "}" : "", members(tail_json(p)));
}

} // namespace

void print_json(std::FILE* out, const piece& p, const environment& e, const score& samples,
                const render_options& options)
{
    const auto starts = starts_of(p.plans);
    const auto print = [&](std::size_t i) {
        print_plan(out, {p.strokes[i], p.plans[i].schedule, starts[i], samples.starts()[i], e.tactors,
                         samples, p.fit, options});
    };
    if (p.plans.size() == 1) {
        print(0);
        fmt::print(out, "\n");
        return;
    }
    fmt::print(out, "{{\"schema\":\"tactor-plans/1\",\"plans\":[\n");
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        print(i);
        fmt::print(out, "{}\n", i + 1 < p.plans.size() ? "," : "");
    }
    fmt::print(out, "]}}\n");
}

} // namespace tactor::cli
