// SPDX-License-Identifier: MIT
#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/report/facts.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

bool is_simulated(const session_facts& s)
{
    return s.facts()["simulated"].truth().value_or(false);
}

// Returns the different values under a key of all openings of the device.
std::string stream_text(const session_facts& s, const std::string& key)
{
    std::set<std::string> seen;
    for (const json_value& one : s.facts()["streams"].list())
        seen.insert(one[key].exists() ? one[key].words() : "none");
    if (seen.empty())
        return is_simulated(s) ? "simulated" : not_recorded;
    return join(seen, "; ");
}

// Lists the motions that were mirrored for the hand that wore the array.
std::string mirrored_text(const session_facts& s)
{
    std::vector<std::string> mirrored;
    if (s.design && s.facts()["hand"].words() == "left")
        for (const motion_definition& m : s.design->motions)
            if (m.mirror)
                mirrored.push_back(m.name);
    return mirrored.empty() ? "none" : join(mirrored);
}

// Lists the days on which a session was held, UTC.
std::string days_text(const session_facts& s)
{
    std::set<std::string> days;
    const auto add = [&days](const std::string& time) { days.insert(time.substr(0, time.find('T'))); };
    add(s.facts()["date"].words());
    for (const json_value& one : s.facts()["streams"].list())
        add(one["opened"].words());
    days.erase("");
    return days.empty() ? not_recorded : join(days);
}

std::string walk_text(const session_facts& s)
{
    std::set<std::string> felt;
    for (const json_value& one : s.facts()["walk"].list())
        felt.insert(one["tactor"].words());
    return felt.empty() && is_simulated(s) ? "simulated" : fmt::format("{}", felt.size());
}

} // namespace

std::string describe_pause(double s)
{
    return s > 0.0 ? plain_number(s) + " s" : "none";
}

nlohmann::ordered_json describe_run(const study_facts& f, const run_outline& o, std::size_t run)
{
    const auto fact = [&](const std::function<std::string(const run_definition&)>& text) {
        return join_texts(f, [&](const session_facts& s) {
            return s.design ? text(s.design->runs.at(run)) : std::string();
        });
    };
    const json attribute = fact([](const run_definition& r) { return r.attribute; });
    const std::string procedure = fact([](const run_definition& r) {
        std::string_view section;
        return task_in(r.outline).describe_procedure(r, section);
    });
    const std::vector<std::string_view> sections = task_in(o).list_sections(o);
    const auto has = [&](std::string_view section) { return std::ranges::count(sections, section) != 0; };
    return {
        {"name", o.name},
        {"task", task_in(o).name()},
        {"asked", task_in(o).describe(o)},
        {"motions", join(o.motions)},
        {"attribute", attribute == not_recorded && !has("has_cells") ? json(false) : attribute},
        {"question", fact([](auto& r) { return r.outline.question; })},
        {"animation", join_texts(f,
                                 [run](const session_facts& s) {
                                     if (!s.design)
                                         return std::string();
                                     return s.design->runs.at(run).animation ? stream_text(s, "display")
                                                                             : std::string("no");
                                 })},
        {"trials", o.trials == 0 ? not_recorded : fmt::format("{}", o.trials)},
        {"practice", fact([](const run_definition& r) { return fmt::format("{}", r.practice); })},
        {"labels", fact([](auto& r) { return r.outline.labels.empty() ? "none" : join(r.outline.labels); })},
        {"choices",
         fact([](const run_definition& r) { return r.choices.empty() ? "none" : join(r.choices); })},
        {"procedure", procedure == not_recorded ? json(false) : json(procedure)},
        {"standard", o.standard ? json(fmt::format("by the same method, with {} of {}", o.vary,
                                                   plain_number(*o.standard)))
                                : json(false)},
        {"catch", has("catches") ? json(fact([](const run_definition& r) {
             return fmt::format("{} %", plain_number(100.0 * r.catch_share));
         }))
                                 : json(false)},
        {"blocks", fact([](const run_definition& r) {
             return r.blocks.empty() ? "none" : fmt::format("the {}, ordered like the runs", r.blocks);
         })},
        {"in_a_row", fact([](const run_definition& r) {
             return r.motions.size() > 1 ? fmt::format("{}", r.max_in_a_row) : "no limit";
         })},
        {"break", fact([](const run_definition& r) { return describe_pause(r.break_s); })},
        {"early", fact([](const run_definition& r) { return plain_number(r.min_response_s) + " s"; })}};
}

nlohmann::ordered_json describe_session(const session_facts& s)
{
    json row{
        {"code", s.code}, {"days", days_text(s)}, {"mirrored", mirrored_text(s)}, {"walk", walk_text(s)}};
    for (const char* key : {"group", "order", "seed", "hand"})
        row[key] = fact_text(s, key);
    if (const json_value at = s.facts()["order_row"]; at.exists())
        row["order"] = fmt::format("{} (row {})", fact_text(s, "order"), at.words());
    for (const char* key : {"display", "masking", "masker"})
        row[key] = stream_text(s, key);
    const auto at = s.facts()["consent"].text();
    row["consent"] = at                                      ? *at
                     : s.design && s.design->consent.empty() ? "not asked for"
                     : is_simulated(s)                       ? "simulated"
                                                             : not_recorded;
    row["counts"] = json::array();
    for (const trial_counts& c : s.counts)
        row["counts"].push_back(fmt::format("{} / {} / {}", c.valid, c.voids,
                                            c.xruns ? fmt::format("{}", *c.xruns) : not_recorded));
    return row;
}

nlohmann::ordered_json list_questionnaires(const study_facts& f)
{
    std::vector<std::string> names;
    for (const session_facts& s : f.sessions)
        if (s.design)
            for (const questionnaire& q : s.design->outline.questionnaires)
                if (std::ranges::count(names, q.name) == 0)
                    names.push_back(q.name);
    json all = json::array();
    for (const std::string& name : names) {
        std::set<std::string> people;
        std::size_t answers = 0;
        const std::string what = join_texts(f, [&](const session_facts& s) -> std::string {
            if (!s.design)
                return {};
            const std::vector<questionnaire>& own = s.design->outline.questionnaires;
            const auto q = std::ranges::find(own, name, &questionnaire::name);
            if (q == own.end())
                return "not asked";
            const std::size_t lines = s.answered[static_cast<std::size_t>(q - own.begin())];
            if (lines > 0)
                people.insert(s.participant);
            answers += lines;
            return fmt::format("{}{}{}, {}", q->title, q->title.empty() ? "" : ", ", describe_time(q->when),
                               counted(q->items.size(), "item"));
        });
        all.push_back(
            {{"name", name},
             {"what", what},
             {"answered", fmt::format("{} of {}, {} in all", people.size(),
                                      counted(f.people.size(), "participant"), counted(answers, "time"))}});
    }
    return all;
}

} // namespace tactor::study
