// SPDX-License-Identifier: MIT
#include "study/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <tactor/render.hpp>
#include <tactor/version.hpp>

#include "core/split.hpp"
#include "core/words.hpp"
#include "options/option.hpp"
#include "study/analysis/result_json.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/report/facts.hpp"
#include "study/results/result_members.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

std::string ages_text(const study_facts& f)
{
    constexpr double oldest = 150.0;
    std::vector<double> ages;
    std::map<std::string, unsigned> others;
    for (const participant& p : f.people) {
        const auto years = detail::parse_number_text<double>(p.age.value_or(""));
        if (years && *years >= 0.0 && *years < oldest)
            ages.push_back(*years);
        else
            ++others[p.age.value_or(not_recorded)];
    }
    if (ages.empty() && others.size() == 1 && others.contains(not_recorded))
        return not_recorded;
    std::vector<std::string> parts;
    if (!ages.empty()) {
        parts.push_back(fmt::format("{} years, mean {:.1f}", range_text(ages), mean(ages)));
        if (ages.size() > 1)
            parts.back() += fmt::format(", sd {:.1f}", deviation(ages, mean(ages)));
        if (!others.empty())
            parts.back() += fmt::format(", of {}", counted(ages.size(), "participant"));
    }
    for (const auto& [age, n] : others)
        parts.push_back(fmt::format("{} {}", n, age));
    return join(parts, "; ");
}

// Counts how often each value of a column occurs.
std::string counts_text(const study_facts& f, std::optional<std::string> participant::*column)
{
    std::map<std::string, unsigned> counts;
    for (const participant& p : f.people)
        ++counts[(p.*column).value_or(not_recorded)];
    std::vector<std::string> parts;
    for (const auto& [value, n] : counts)
        parts.push_back(fmt::format("{} {}", n, value));
    return counts.size() == 1 && counts.contains(not_recorded) ? not_recorded : join(parts);
}

// Returns a fact of a session in words, or "none" if the fact is null.
std::string fact_text(const session_facts& s, const std::string& key)
{
    if (!s.document.contains(key))
        return not_recorded;
    const std::string words = s.facts()[key].words();
    return words.empty() ? "none" : words;
}

template <class Texts>
std::string join_or_none(const Texts& texts)
{
    return texts.empty() ? "none" : join(texts);
}

json pause_json(double s)
{
    return s > 0.0 ? json(s) : json(false);
}

bool is_simulated(const session_facts& s)
{
    return s.facts()["simulated"].truth().value_or(false);
}

// Returns the different values of a key in the session's list of streams.
std::string stream_text(const session_facts& s, const std::string& key)
{
    std::set<std::string> seen;
    for (const json_value& one : s.facts()["streams"].list())
        seen.insert(one[key].exists() ? one[key].words() : "none");
    return !seen.empty() ? join(seen, "; ") : is_simulated(s) ? "simulated" : not_recorded;
}

// Returns the acceleration at each carrier, computed from the measured displacement. Empty if no displacement
// was measured.
std::string acceleration_text(const session_facts& s)
{
    constexpr double m_per_um = 1e-6;
    std::map<double, std::vector<double>> by_carrier;
    for (const json_value& t : s.facts()["array"]["tactors"].list())
        if (const auto um = t["displacement_um_at_0dbfs"].number())
            for (const planned_stimulus& p : s.stimuli)
                for (const json_value& plan : p.list_plans())
                    if (const auto hz = plan["stroke"]["carrier_hz"].number())
                        by_carrier[*hz].push_back(*um * m_per_um *
                                                  std::pow(2.0 * std::numbers::pi * *hz, 2.0));
    std::vector<std::string> parts;
    for (const auto& [hz, m_s2] : by_carrier)
        parts.push_back(fmt::format("{} m/s2 at {} Hz", range_text(m_s2), plain_number(hz)));
    return join(parts);
}

// Describes a threshold, or a list of thresholds at several frequencies.
std::string describe_threshold(const json_value& t)
{
    if (!t.is_list())
        return t.exists() ? plain_number(t.need_number()) : "none";
    std::vector<std::string> parts;
    for (const json_value& pair : t.list()) {
        const std::vector<double> hz_and_dbfs = pair.need_numbers();
        if (hz_and_dbfs.size() != 2)
            pair.refuse("it is not a frequency with a threshold");
        parts.push_back(
            fmt::format("{} at {} Hz", plain_number(hz_and_dbfs[1]), plain_number(hz_and_dbfs[0])));
    }
    return join(parts);
}

// Makes a row of thresholds for each session, and a row with mean and standard deviation of each tactor.
json tabulate_thresholds(const study_facts& f)
{
    json rows = json::array();
    std::vector<std::vector<double>> columns;
    for (const session_facts& s : f.sessions) {
        json values = json::array();
        const std::vector<json_value> all = s.facts()["thresholds_dbfs"].list();
        if (std::none_of(all.begin(), all.end(), [](const json_value& t) { return t.exists(); }))
            continue;
        columns.resize(std::max(columns.size(), all.size()));
        for (const json_value& t : all) {
            if (t.exists() && !t.is_list())
                columns[values.size()].push_back(t.need_number());
            values.push_back(describe_threshold(t));
        }
        rows.push_back({{"who", "sub-" + s.code}, {"values", values}});
    }
    json summary = json::array();
    json numbers = json::array();
    for (const std::vector<double>& column : columns) {
        std::string text = column.empty() ? "none" : fmt::format("{:.2f}", mean(column));
        if (column.size() > 1)
            text += fmt::format(" ({:.2f})", deviation(column, mean(column)));
        summary.push_back(text);
        numbers.push_back(fmt::format("{}", numbers.size()));
    }
    rows.push_back({{"who", "mean (sd)"}, {"values", summary}});
    return columns.empty() ? json(false) : json{{"numbers", numbers}, {"rows", rows}};
}

// Cuts the intervals of means to the possible range, because t intervals may exceed it.
void clamp_intervals(json& results, const interval& possible)
{
    if (const auto ci = results.find("ci"); ci != results.end() && ci->is_array())
        for (json& end : *ci)
            end = std::clamp(end.get<double>(), possible.first, possible.second);
    for (json& inner : results)
        if (inner.is_object())
            clamp_intervals(inner, possible);
}

// Converter of a result to the facts of methods.md. The facts are under the name of the result's kind.
class row_facts {
public:
    explicit row_facts(const result& r) : all_(value_json(r.value))
    {
        std::visit(*this, r.value);
        all_ = {{"heading", r.heading.empty() ? json(false) : json(r.heading)}, {kind_, std::move(all_)}};
    }

    json finish() && { return std::move(all_); }

    template <class T>
    void operator()(const T&)
    {
    }
    void operator()(const cell_means& v)
    {
        kind_ = v.against ? "tests" : "means";
        clamp_intervals(all_, v.possible);
    }
    void operator()(const interval_share&) { kind_ = "first_interval"; }
    void operator()(const method_difference&) { kind_ = "paired"; }
    void operator()(const effect_list&) { kind_ = "anova"; }
    void operator()(const tukey_list&) { set_rows("tukey"); }
    void operator()(const paired_list&) { set_rows("pairs"); }
    void operator()(const figure_comparison&) { kind_ = "compared"; }
    void operator()(const answer_counts& v)
    {
        kind_ = "confusion";
        all_ = {{"motions", v.motions}, {"rows", std::move(all_)}};
    }
    void operator()(const worth_list& v)
    {
        kind_ = "bradley_terry";
        json rows = json::array();
        for (const std::string& m : v.methods)
            rows.push_back(
                {{"name", m}, {"log_worth", all_.at("log_worth").at(m)}, {"se", all_.at("se").at(m)}});
        all_["rows"] = std::move(rows);
    }
    void operator()(const method_map& v)
    {
        kind_ = "scaling";
        json rows = json::array();
        for (std::size_t m = 0; m < v.methods.size(); ++m)
            rows.push_back(
                {{"name", v.methods[m]}, {"x", v.all.scaled.places[m][0]}, {"y", v.all.scaled.places[m][1]}});
        all_ = {{"rows", std::move(rows)}, {"stress", v.all.scaled.stress}};
    }
    // Only the main figure is tested, and only if there is a value to test against.
    void operator()(const psychometric_functions& v)
    {
        kind_ = "psychometric";
        for (const measured_figure& f : v.figures)
            if (!f.against)
                for (const char* key : {"t", "df", "p", "p_signflip", "d", "d_ci"})
                    all_["tests"][f.name][key] = nullptr;
        all_["against"] = files::or_null(v.figures.front().against);
    }
    void operator()(const sensitivities&) { kind_ = "dprime"; }
    void operator()(const oddities&) { kind_ = "oddity"; }
    void operator()(const exponents&) { kind_ = "exponent"; }
    void operator()(const adjustments&) { kind_ = "adjustment"; }
    void operator()(const interval_effects&) { kind_ = "intervals"; }
    void operator()(const drawn_answers&) { kind_ = "drawings"; }

private:
    void set_rows(const char* kind)
    {
        kind_ = kind;
        all_ = {{"rows", std::move(all_)}};
    }

    const char* kind_ = "";
    json all_;
};

json describe_results(const run_analysis& r)
{
    json run{{"name", r.run.name},
             {"n", r.n},
             {"trials", r.trials},
             {"early", r.early},
             {"dropped", r.dropped != 0 ? json(r.dropped) : json()},
             {"left_out", files::make_document(r.missing)},
             {"tracks", r.tracks.empty() ? json() : json(describe_tracks(r))},
             {"rows", json::array()},
             {"response_time", files::make_document(r.times)}};
    for (const result& row : r.results)
        if (r.n != 0 && has_table(row.value))
            run["rows"].push_back(row_facts(row).finish());
    return run;
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

// Returns the facts about a session's definition. Empty if another program wrote the session, because that
// program may have other defaults.
json describe_design(const session_facts& s)
{
    if (!s.design)
        return json::object();
    const experiment_definition& d = *s.design;
    json all{{"pairs", std::ranges::any_of(d.runs, [](const auto& r) { return r.stimuli > 1; })},
             {"gap_s", d.gap_s},
             {"rest_s", d.rest.is_random() ? json(range_text({d.rest.least_s, d.rest.most_s}))
                                           : pause_json(d.rest.least_s)},
             {"drawn", d.rest.is_random()},
             {"order", {{d.order, true}}},
             {"laws", json::array()}};
    std::set<std::pair<double, double>> laws;
    for (const method_definition& m : d.methods)
        laws.emplace(m.options.plan.profile.slope, m.options.plan.profile.intercept_s);
    for (const auto& [slope, intercept_s] : laws)
        all["laws"].push_back(
            {{"and", !all["laws"].empty()}, {"slope", slope}, {"intercept_s", intercept_s}});
    return all;
}

// Returns the facts about a session, from its file and its trials.
json describe_session(const session_facts& s)
{
    const json_value from = s.facts();
    const std::vector<json_value> tactors = from["array"]["tactors"].list();
    const bool in_dbfs = from["level"]["dbfs"].number().has_value();
    const bool used = s.design ? uses_thresholds(*s.design) : !in_dbfs;
    const bool assumed = from["thresholds_assumed"].truth().value_or(false);
    std::set<std::string> walked;
    for (const json_value& one : from["walk"].list())
        walked.insert(one["tactor"].words());
    std::vector<std::string> mirrored;
    if (s.design && from["hand"].words() == "left")
        for (const motion_definition& m : s.design->motions)
            if (m.mirror)
                mirrored.push_back(m.name);
    json row{
        {"code", s.code},
        {"carrier", describe_carrier(s)},
        {"acceleration", acceleration_text(s)},
        {"definition", s.definition_hash},
        {"days", days_text(s)},
        {"mirrored", join_or_none(mirrored)},
        {"walk", walked.empty() && is_simulated(s) ? "simulated" : fmt::format("{}", walked.size())},
        {"consent", from["consent"].text().value_or(s.design && s.design->consent.empty() ? "not asked for"
                                                    : is_simulated(s)                     ? "simulated"
                                                                                          : not_recorded)},
        {"counts", json::array()}};
    const auto add = [&](const char* key, std::initializer_list<const char*> members) {
        if (const json_value own = from[key]; own.exists())
            for (const char* member : members)
                row[key][member] = files::or_null(own[member].words());
    };
    add("array", {"name"});
    add("level", {"sl_db", "dbfs"});
    add("codes", {"channel", "bit_ms", "lines", "serial", "lsl"});
    add("calibration", {"participant", "method", "rule", "carrier_hz", "interval_s", "feedback", "masker",
                        "date", "simulated", "warnings"});
    add("versions", {"tactor", "build"});
    if (row.contains("codes"))
        row["codes"]["baud"] = from["codes"]["serial"]["baud"].words();
    if (const json_value place = from["order_row"]; place.exists())
        row["order_row"] = place.words();
    for (const json_value& t : tactors) {
        json one{{"number", row["array"]["tactors"].size()}};
        for (const char* key : {"x_mm", "y_mm", "channel", "polarity", "gain_db", "max_dbfs", "actuator",
                                "displacement_um_at_0dbfs"})
            one[key] = t[key].words();
        row["array"]["tactors"].push_back(std::move(one));
    }
    if (row.contains("array"))
        row["array"]["size"] = counted(tactors.size(), "tactor");
    if (from["thresholds_assumed"].exists())
        row["thresholds"] = {{"unused", !used}, {"assumed", used && assumed}, {"measured", used && !assumed}};
    for (const char* key :
         {"rate", "channels", "device", "sound_server", "simulation", "group", "order", "seed", "hand"})
        row[key] = fact_text(s, key);
    for (const char* key : {"display", "masking", "masker"})
        row[key] = stream_text(s, key);
    if (s.design)
        for (const method_definition& m : s.design->methods)
            if (const render_options& o = m.options.render; m.has_level() && !m.is_variant())
                row["own_levels"].push_back({{"name", m.name},
                                             {"value", o.sl_db.value_or(o.level_dbfs)},
                                             {"unit", o.sl_db ? "dB SL" : "dBFS"}});
    for (const trial_counts& c : s.counts)
        row["counts"].push_back({{"valid", c.valid}, {"voids", c.voids}, {"xruns", files::or_null(c.xruns)}});
    return row;
}

// Returns the facts about a run in a session. Adds the sections that the run's procedure needs to `sections`.
json describe_run(const session_facts& s, std::size_t run, std::set<std::string_view>& sections)
{
    if (!s.design)
        return json::object();
    const run_definition& r = s.design->runs.at(run);
    return {{"attribute", r.attribute},
            {"question", r.outline.question},
            {"animation", r.animation ? stream_text(s, "display") : "no"},
            {"practice", r.practice},
            {"feedback", r.feedback ? "in all trials"
                         : r.trains ? "in practice"
                                    : ""},
            {"labels", join_or_none(r.outline.labels)},
            {"choices", join_or_none(r.choices)},
            {"procedure", find_run_task(r.outline).describe_procedure(r, sections)},
            {"catch_percent", 100.0 * r.catch_share},
            {"blocks", files::or_null(r.blocks)},
            {"in_a_row", r.motions.size() > 1 ? fmt::format("{}", r.max_in_a_row) : "no limit"},
            {"break_s", pause_json(r.break_s)},
            {"min_response_s", r.min_response_s}};
}

// Returns true if any row has a non-empty value for a key.
bool has_value_in_rows(const json& rows, const char* key)
{
    return std::ranges::any_of(rows, [key](const json& row) { return row.value(key, json("")) != ""; });
}

// Returns the facts about a run. `each`: facts about the run in each session.
json describe_outline(const run_outline& o, json each)
{
    const std::vector<std::string_view> sections = find_run_task(o).list_sections(o);
    const auto has = [&](std::string_view section) { return std::ranges::count(sections, section) != 0; };
    return {{"name", o.name},
            {"task", find_run_task(o).name()},
            {"asked", find_run_task(o).describe(o)},
            {"motions", join(o.motions)},
            {"attributed", has("has_cells") || has_value_in_rows(each, "attribute")},
            {"trials", o.trials == 0
                           ? not_recorded
                           : fmt::format("{}{}", o.adaptive.may_end_early() ? "at most " : "", o.trials)},
            {"only_in", o.sessions.empty() ? json() : json(fmt::format("{}", fmt::join(o.sessions, ", ")))},
            {"told", has_value_in_rows(each, "feedback")},
            {"adapts", has_value_in_rows(each, "procedure")},
            {"vary", o.vary},
            {"standard", files::or_null(o.standard)},
            {"catches", has("catches")},
            {"each", std::move(each)}};
}

// Lists the questionnaires of all definitions, with the time of asking, the items, and the number of answers.
json list_questionnaires(const study_facts& f)
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
        json each = json::array();
        for (const session_facts& s : f.sessions) {
            json& own = each.emplace_back(json::object());
            if (!s.design)
                continue;
            const std::vector<questionnaire>& asked = s.design->outline.questionnaires;
            const auto q = std::ranges::find(asked, name, &questionnaire::name);
            own["asked"] = q != asked.end();
            if (q == asked.end())
                continue;
            const std::size_t lines = s.answered[static_cast<std::size_t>(q - asked.begin())];
            if (lines > 0)
                people.insert(s.participant);
            answers += lines;
            own.update({{"title", files::or_null(q->title)},
                        {"when", describe_time(q->when)},
                        {"items", counted(q->items.size(), "item")}});
        }
        all.push_back({{"name", name},
                       {"each", std::move(each)},
                       {"people", people.size()},
                       {"of", counted(f.people.size(), "participant")},
                       {"times", counted(answers, "time")}});
    }
    return all;
}

} // namespace

nlohmann::ordered_json collect_facts(const study_facts& f, const dataset& d, const analysis& a)
{
    std::set<std::string_view> sections; // sections of the template to show
    for (const run_outline& r : d.experiment.runs)
        for (const std::string_view section : find_run_task(r).list_sections(r))
            sections.insert(section);
    const auto for_each_session = [&f](const auto& describe) {
        json all = json::array();
        for (const session_facts& s : f.sessions)
            all.push_back(describe(s));
        return all;
    };
    const json sessions = for_each_session([&d](const session_facts& s) {
        json row = describe_session(s);
        row["title"] = s.design ? s.design->title : d.experiment.name;
        return row;
    });
    const json design = for_each_session(describe_design);
    std::vector<std::string> codes;
    for (const participant& p : f.people)
        codes.push_back(p.code);
    json all{{"version", std::string(version())},
             {"experiment", d.experiment.name},
             {"sessions", sessions},
             {"each", sessions},
             {"alike", sessions},
             {"design", {{"each", design}}},
             {"simulation", d.simulated}};
    all["participants"] = fmt::format("{}: {}", counted(codes.size(), "participant"), format_subjects(codes));
    all["age"] = ages_text(f);
    all["sex"] = counts_text(f, &participant::sex);
    all["handedness"] = counts_text(f, &participant::handedness);
    all["coded"] = has_value_in_rows(sessions, "codes");
    all["accelerated"] = has_value_in_rows(sessions, "acceleration");
    all["thresholds"] = tabulate_thresholds(f);
    all["calibrated"] = has_value_in_rows(sessions, "calibration");
    all["bursts"] = std::ranges::any_of(f.sessions, has_bursts);
    all["methods"] = list_methods(f);
    json& equations = all["equations"] = json::object(); // the keys are names in the plans
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            for (const json_value& plan : p.list_plans())
                for (const char* key : {"algorithm", "phantom"})
                    equations[plan[key].need_text()] = true;
    all["stimuli"] = list_stimuli(f);
    all["recorded"] = !all["stimuli"].empty();
    all["valued"] = has_value_in_rows(all["stimuli"], "value");
    all["notes"] = list_notes(f);
    all["gap"] = std::ranges::any_of(design, [](const json& one) { return one.value("pairs", false); });
    all["several"] = d.experiment.sessions > 1
                         ? json{{"number", d.experiment.sessions}, {"between", session_gap_text(f)}}
                         : json(false);
    all["groups"] = json::array();
    for (const group_outline& g : d.experiment.groups)
        all["groups"].push_back({{"name", g.name}, {"runs", describe_group(g)}});
    all["grouped"] = !d.experiment.groups.empty();
    all["runs"] = json::array();
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i)
        all["runs"].push_back(describe_outline(
            d.experiment.runs[i],
            for_each_session([&](const session_facts& s) { return describe_run(s, i, sections); })));
    all["questionnaires"] = list_questionnaires(f);
    for (const std::string_view section : sections)
        all[std::string(section)] = true;
    all["ordered"] =
        std::ranges::any_of(f.sessions, [](const session_facts& s) { return s.design.has_value(); });
    all["held"] = !f.sessions.empty();
    all["excluded"] = files::make_document(d.excluded);
    all["drop_rule"] = d.drop_rule;
    all["results"] = json::array();
    for (const run_analysis& r : a.runs)
        all["results"].push_back(describe_results(r));
    all["warnings"] = a.warnings;
    for (const std::string& w : a.no_figures)
        all["warnings"].push_back(w);
    return all;
}

std::string range_text(const std::vector<double>& values)
{
    if (values.empty())
        return not_recorded;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const std::string from = plain_number(*low);
    const std::string to = plain_number(*high);
    return from == to ? from : fmt::format("{} to {}", from, to);
}

std::string method_options(const options::option_values& o)
{
    std::vector<std::string> parts;
    for (const options::option& row : options::all()) {
        if ((row.where & options::in_method) == 0 || (row.used != nullptr && !row.used(o)) ||
            ((row.where & options::unstated) != 0 && !o.gives(row)))
            continue;
        const options::value v = row.to.get(o);
        if (const auto* number = std::get_if<double>(&v))
            parts.push_back(fmt::format("{} {}", row.name, plain_number(*number)));
        else if (const auto* text = std::get_if<std::string>(&v))
            parts.push_back(fmt::format("{} {}", row.name, *text));
        else if (v == options::value(true))
            parts.emplace_back(row.name);
    }
    return join(parts);
}

} // namespace tactor::study
