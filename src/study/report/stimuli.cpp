// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/report/facts.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

// Joins the different texts that `text` returns for the plans of a session.
template <class F>
std::string join_plans(const session_facts& s, const F& text, const char* between = ", ")
{
    std::set<std::string> seen;
    for (const planned_stimulus& p : s.stimuli)
        for (const json_value& plan : p.list_plans())
            seen.insert(text(p, plan));
    seen.erase("");
    return join(seen, between);
}

std::vector<double> list_burst_numbers(const json_value& plan, const char* key)
{
    std::vector<double> all;
    for (const json_value& b : plan["bursts"].list())
        if (const auto v = b[key].number())
            all.push_back(*v);
    return all;
}

// Describes the wave, its phase and envelope, and the rise times of actuators.
std::string describe_sound(const planned_stimulus&, const json_value& plan)
{
    const json_value stroke = plan["stroke"];
    std::string text = stroke["waveform"].text().value_or("sine");
    for (const char* key :
         {"carrier_hz", "noise_seed", "am_hz", "am_depth", "texture", "texture_mm", "course"})
        if (stroke[key].exists())
            text += fmt::format(", {} {}", key, stroke[key].words());
    text += fmt::format(", phase {}", plan["render"]["phase"].words());
    const json_value envelope = plan["render"]["envelope"];
    text += envelope.exists() ? ", envelope " + envelope.words() : ", raised-cosine ramps";
    for (const json_value& t : plan["array"]["tactors"].list())
        if (t["rise_s"].exists())
            text += fmt::format(", tactor {} rises in {} s", t["tactor"].words(), t["rise_s"].words());
    return text;
}

// Returns true if `name` is the name of a method. Other names stand for a standard or for silence.
bool is_method(const session_facts& s, const std::string& name)
{
    return !s.design || std::ranges::any_of(s.design->methods, [&](const method_definition& m) {
        return m.name == name && !m.is_variant();
    });
}

// Returns the name of the option or parameter that a stimulus varies. Empty if there is none.
std::string find_varied(const session_facts& s, const planned_stimulus& p)
{
    if (p.value && s.design)
        for (const run_definition& r : s.design->runs) {
            const run_outline& o = r.outline;
            const bool is_its = is_method(s, p.method) ? std::ranges::count(o.methods, p.method) != 0 &&
                                                             std::ranges::count(o.values, *p.value) != 0
                                                       : o.standard == p.value;
            if (is_its && std::ranges::count(o.motions, p.motion) != 0)
                return o.vary;
        }
    return {};
}

// Plans that are shown in one row.
struct stimulus_row {
    std::map<std::string, std::set<double>> values = {}; // values by option
    std::vector<const planned_stimulus*> plans = {};     // different plans
    std::vector<std::string> codes = {};                 // codes of the participants
};

json describe_stimuli(const stimulus_row& row)
{
    const auto range = [&row](const auto& get) {
        std::vector<double> all;
        for (const planned_stimulus* p : row.plans)
            for (const json_value& plan : p->list_plans())
                if (const auto v = get(plan).number())
                    all.push_back(*v);
        return all.empty() ? "-" : range_text(all);
    };
    std::set<std::string> paths;
    std::vector<double> counts;
    std::vector<double> bursts_s;
    std::vector<double> overlaps;
    for (const planned_stimulus* p : row.plans) {
        for (const json_value& plan : p->list_plans()) {
            const std::vector<double> own = list_burst_numbers(plan, "duration_s");
            paths.insert(plan["stroke"]["name"].words());
            counts.push_back(static_cast<double>(own.size()));
            bursts_s.insert(bursts_s.end(), own.begin(), own.end());
            overlaps.push_back(static_cast<double>(plan["conflicts"].list().size()));
        }
    }
    std::vector<std::string> values;
    for (const auto& [option, all] : row.values)
        values.push_back(
            option + " " +
            (row.plans.size() == 1
                 ? join(all)
                 : fmt::format("{} ({} values)", range_text({all.begin(), all.end()}), all.size())));
    return {{"motion", row.plans[0]->motion},
            {"method", row.plans[0]->method},
            {"value", join(values)},
            {"path", join(paths)},
            {"target_s", range([](const json_value& p) { return p["stroke"]["duration_s"]; })},
            {"length_mm", range([](const json_value& p) { return p["stroke"]["length_mm"]; })},
            {"soa_s", range([](const json_value& p) { return p["soa_s"]; })},
            {"bursts", bursts_s.empty()
                           ? "continuous"
                           : fmt::format("{} of {} s", range_text(counts), range_text(bursts_s))},
            {"total_s", range([](const json_value& p) { return p["total_s"]; })},
            {"overlaps", range_text(overlaps)},
            {"hash", row.plans.size() == 1 ? fmt::format("`{}`", row.plans[0]->hash)
                                           : counted(row.plans.size(), "plan")}};
}

} // namespace

std::string describe_carrier(const session_facts& s)
{
    std::vector<double> ramps;
    for (const planned_stimulus& p : s.stimuli)
        for (const json_value& plan : p.list_plans())
            for (const double ramp_s : list_burst_numbers(plan, "ramp_s"))
                ramps.push_back(ramp_s);
    return join_plans(s, describe_sound, "; ") +
           (ramps.empty() ? "" : fmt::format("; ramps of {} s at both ends of a burst", range_text(ramps)));
}

bool has_bursts(const session_facts& s)
{
    return std::ranges::any_of(s.stimuli, [](const planned_stimulus& p) {
        return std::ranges::any_of(p.list_plans(), [](const json_value& plan) {
            return !list_burst_numbers(plan, "duration_s").empty();
        });
    });
}

nlohmann::ordered_json list_methods(const study_facts& f)
{
    std::vector<std::string> names;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            if (is_method(s, p.method) && std::ranges::count(names, p.method) == 0)
                names.push_back(p.method);
    json all = json::array();
    for (const std::string& name : names) {
        all.push_back({{"name", name}, {"each", json::array()}});
        for (const session_facts& s : f.sessions) {
            json own = json::object();
            for (const char* key : {"algorithm", "phantom"})
                own[key] = join_plans(s, [&](const planned_stimulus& p, const json_value& plan) {
                    return p.method == name ? plan[key].words() : "";
                });
            if (s.design)
                if (const auto m = std::ranges::find(s.design->methods, name, &method_definition::name);
                    m != s.design->methods.end())
                    own["options"] = method_options(m->options);
            all.back()["each"].push_back(std::move(own));
        }
    }
    return all;
}

nlohmann::ordered_json list_stimuli(const study_facts& f)
{
    constexpr std::size_t most_values = 12;   // with more values, an option has one row with ranges
    using place = std::array<std::string, 3>; // motion, method, and an option or a plan
    std::map<place, std::set<double>> values;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            if (p.value)
                values[{p.motion, p.method, find_varied(s, p)}].insert(*p.value);
    std::vector<std::pair<place, stimulus_row>> rows;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli) {
            const std::string varied = find_varied(s, p);
            place key{p.motion, p.method, varied};
            if (!p.value || values.at(key).size() <= most_values)
                key[2] = p.hash;
            auto at = std::ranges::find(rows, key, &decltype(rows)::value_type::first);
            if (at == rows.end())
                at = rows.insert(at, {key, {}});
            stimulus_row& row = at->second;
            if (p.value)
                row.values[varied].insert(*p.value);
            if (std::ranges::none_of(row.plans, [&p](const auto* one) { return one->hash == p.hash; }))
                row.plans.push_back(&p);
            if (row.codes.empty() || row.codes.back() != s.code)
                row.codes.push_back(s.code);
        }
    json all = json::array();
    for (const auto& [key, row] : rows) {
        all.push_back(describe_stimuli(row));
        all.back()["who"] = row.codes.size() == f.sessions.size() ? "all" : format_subjects(row.codes);
    }
    return all;
}

std::vector<std::string> list_notes(const study_facts& f)
{
    std::map<std::pair<std::string, std::string>, std::set<std::string>>
        notes; // by stimulus and by note without numbers
    const auto add = [&notes](const std::string& about, const std::string& note) {
        std::string kind = note;
        std::erase_if(kind, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
        notes[{about, kind}].insert(note);
    };
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            for (const json_value& plan : p.list_plans()) {
                const std::string of = fmt::format("{} with {}", p.motion, p.method);
                if (const std::string note = plan["stroke"]["note"].words(); !note.empty())
                    add(p.motion, note);
                if (const auto db = plan["weakened_db"].number(); db && *db < 0.0)
                    add(of,
                        fmt::format("{:.2f} dB weaker than the level, so that no tactor exceeds it", -*db));
                for (const json_value& w : plan["warnings"].list())
                    add(of, w.need_text());
            }
    std::vector<std::string> all;
    for (const auto& [key, texts] : notes) {
        const std::size_t more = texts.size() - 1;
        all.push_back(fmt::format("{}: {}{}", key.first, *texts.begin(),
                                  more == 0 ? "" : fmt::format("; and {} more like it", more)));
    }
    return all;
}

} // namespace tactor::study
