// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/plan_output.hpp"
#include "cli/plan_rows.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

json drives_json(const std::vector<drive>& drives, const array& a)
{
    json list = json::array();
    for (const drive& d : drives)
        list.push_back(
            {{"tactor", d.tactor}, {"channel", a.tactors[d.tactor].channel}, {"amplitude", d.amplitude}});
    return list;
}

json burst_json(const burst& b, const array& a, bool sampled)
{
    json j;
    if (sampled) {
        j["t_s"] = b.onset_s;
    } else {
        j["onset_s"] = b.onset_s;
        j["duration_s"] = b.duration_s;
    }
    if (b.tau_s)
        j["tau_s"] = *b.tau_s;
    j["x_mm"] = b.position.x_mm;
    j["y_mm"] = b.position.y_mm;
    j["intensity"] = b.intensity;
    j["drives"] = drives_json(b.drives, a);
    return j;
}

json array_json(const array& a)
{
    json tactors = json::array();
    for (unsigned i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        tactors.push_back(
            {{"tactor", i}, {"x_mm", t.position.x_mm}, {"y_mm", t.position.y_mm}, {"channel", t.channel}});
    }
    return {{"name", a.name}, {"tactors", tactors}};
}

// One object without its rows: they are streamed between head and tail.
json head_json(const stroke& s, const plan& p, double start_s, const array& a)
{
    json j;
    j["schema"] = "tactor-plan/1";
    j["algorithm"] = p.algorithm;
    j["phantom"] = p.phantom;
    j["start_s"] = start_s;
    j["stroke"] = {{"name", s.name},
                   {"duration_s", p.stroke_duration_s},
                   {"length_mm", p.stroke_length_mm},
                   {"carrier_hz", p.carrier_hz}};
    if (!s.note.empty())
        j["stroke"]["note"] = s.note;
    j["array"] = array_json(a);
    j["soa_s"] = p.soa_s ? json(*p.soa_s) : json(nullptr);
    j["total_s"] = p.total_s;
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

// The members of an object without its braces, so that objects can be joined.
std::string members(const json& j)
{
    const std::string text = j.dump();
    return text.substr(1, text.size() - 2);
}

void print_plan(std::FILE* out, const stroke& s, const plan& p, double start_s, const array& a)
{
    fmt::print(out, "{{{},\n", members(head_json(s, p, start_s, a)));
    const bool sampled = static_cast<bool>(p.at);
    if (sampled)
        fmt::print(out, "\"bursts\":[],\n\"continuous\":{{\"step_s\":{},\"points\":[", continuous_step_s);
    else
        fmt::print(out, "\"bursts\":[");
    const char* separator = "\n  ";
    for_each_row(p, [&](const burst& b) {
        fmt::print(out, "{}{}", separator, burst_json(b, a, sampled).dump());
        separator = ",\n  ";
    });
    fmt::print(out, "]{},\n{}}}", sampled ? "}" : "", members(tail_json(p)));
}

} // namespace

void print_json(std::FILE* out, const piece& p, const environment& e)
{
    const auto starts = starts_of(p.plans);
    if (p.plans.size() == 1) {
        print_plan(out, p.strokes[0], p.plans[0].schedule, starts[0], e.tactors);
        fmt::print(out, "\n");
        return;
    }
    fmt::print(out, "{{\"schema\":\"tactor-plans/1\",\"plans\":[\n");
    for (std::size_t i = 0; i < p.plans.size(); ++i) {
        print_plan(out, p.strokes[i], p.plans[i].schedule, starts[i], e.tactors);
        fmt::print(out, "{}\n", i + 1 < p.plans.size() ? "," : "");
    }
    fmt::print(out, "]}}\n");
}

} // namespace tactor::cli
