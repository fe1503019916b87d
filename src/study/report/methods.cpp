// SPDX-License-Identifier: MIT
#include "study/report/report.hpp"

#include <algorithm>
#include <cmath>
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
#include "study/experiment/trials.hpp"
#include "study/report/facts.hpp"
#include "study/results/result_json.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

std::string list_subjects(const std::vector<std::string>& codes)
{
    return "sub-" + join(codes, ", sub-");
}

std::string ages_text(const study_facts& f)
{
    constexpr double oldest = 150.0;
    std::vector<double> ages;
    std::map<std::string, unsigned> others;
    for (const participant& p : f.people) {
        const auto years = detail::number_in<double>(p.age.value_or(""));
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

std::string describe_array(const session_facts& s)
{
    const json_value a = s.facts()["array"];
    return a.exists()
               ? fmt::format("{}, {}", a["name"].words(), counted(a["tactors"].list().size(), "tactor"))
               : "";
}

// Facts in the order in which they came, each with the sessions that have it.
template <class Fact>
using shared_facts = std::vector<std::pair<Fact, std::vector<std::string>>>;

template <class Fact>
void add_fact(shared_facts<Fact>& all, const Fact& fact, const std::string& code)
{
    auto at = std::ranges::find(all, fact, &shared_facts<Fact>::value_type::first);
    if (at == all.end())
        at = all.emplace(at, fact, std::vector<std::string>());
    if (at->second.empty() || at->second.back() != code) // two stimuli of a session may be the same
        at->second.push_back(code);
}

// Lists the tactors of each array, and who wore it.
json list_arrays(const study_facts& f)
{
    shared_facts<json> tables;
    for (const session_facts& s : f.sessions) {
        json tactors = json::array();
        for (const json_value& t : s.facts()["array"]["tactors"].list()) {
            json row{{"number", tactors.size()}};
            for (const char* key : {"x_mm", "y_mm", "channel", "polarity", "gain_db", "max_dbfs", "actuator",
                                    "displacement_um_at_0dbfs"})
                row[key] = t[key].words();
            tactors.push_back(row);
        }
        add_fact(tables, tactors, s.code);
    }
    json all = json::array();
    for (const auto& [tactors, codes] : tables)
        all.push_back({{"who", name_subjects(f, codes)}, {"tactors", tactors}});
    return all;
}

// Returns the acceleration that follows from the measured displacement at each carrier; empty if none was
// measured.
std::string acceleration_text(const session_facts& s)
{
    constexpr double m_per_um = 1e-6;
    std::map<double, std::vector<double>> by_carrier;
    for (const json_value& t : s.facts()["array"]["tactors"].list())
        if (const auto um = t["displacement_um_at_0dbfs"].number())
            for (const planned_stimulus& p : s.stimuli)
                if (const auto hz = p.facts()["stroke"]["carrier_hz"].number())
                    by_carrier[*hz].push_back(*um * m_per_um * std::pow(2.0 * std::numbers::pi * *hz, 2.0));
    std::vector<std::string> parts;
    for (const auto& [hz, m_s2] : by_carrier)
        parts.push_back(fmt::format("{} m/s2 at {} Hz", range_text(m_s2), plain_number(hz)));
    return join(parts);
}

// Describes where the codes of a session went.
std::string codes_text(const session_facts& s)
{
    const json_value codes = s.facts()["codes"];
    if (!codes.exists())
        return "none";
    std::vector<std::string> places;
    if (codes["channel"].exists())
        places.push_back(fmt::format("channel {} (bits of {} ms, exact to the sample)",
                                     codes["channel"].words(), codes["bit_ms"].words()));
    if (codes["lines"].exists())
        places.push_back("GPIO lines " + codes["lines"].words());
    if (codes["serial"].exists())
        places.push_back(fmt::format("a serial port ({} baud)", codes["serial"]["baud"].words()));
    if (codes["lsl"].exists())
        places.emplace_back("markers of LSL");
    return join(places);
}

// Describes the experiment's level, and then the levels of methods that have their own.
std::string describe_level(const session_facts& s)
{
    const json_value level = s.facts()["level"];
    std::string text;
    if (const auto sl = level["sl_db"].number())
        text = fmt::format("{0} dB above each tactor's detection threshold ({0} dB SL)", plain_number(*sl));
    else if (const auto dbfs = level["dbfs"].number())
        text = fmt::format("{} dBFS, the same for all tactors except for their gains", plain_number(*dbfs));
    if (s.design)
        for (const method_definition& m : s.design->methods)
            if (const render_options& o = m.options.render; m.has_level() && !m.is_variant())
                text += fmt::format("; by {} {} {}", m.name, plain_number(o.sl_db.value_or(o.level_dbfs)),
                                    o.sl_db ? "dB SL" : "dBFS");
    return text;
}

std::string assumed_text(const session_facts& s)
{
    const auto assumed = s.facts()["thresholds_assumed"].truth();
    const bool used = s.design ? uses_thresholds(*s.design) : !s.facts()["level"]["dbfs"].exists();
    return !assumed   ? ""
           : !used    ? "not used: the level is in dBFS"
           : *assumed ? "assumed, not measured, for tactors without one"
                      : "from the array file, none assumed";
}

// Returns a threshold, or those at several frequencies.
std::string describe_threshold(const json_value& t)
{
    if (!t.is_list())
        return t.exists() ? plain_number(t.need_number()) : "none";
    std::vector<std::string> parts;
    for (const json_value& pair : t.list()) {
        const std::vector<double> hz_and_dbfs = pair.need_numbers();
        if (hz_and_dbfs.size() != 2)
            pair.refuse("is not a frequency with a threshold");
        parts.push_back(
            fmt::format("{} at {} Hz", plain_number(hz_and_dbfs[1]), plain_number(hz_and_dbfs[0])));
    }
    return join(parts);
}

// Makes a row of thresholds for each participant, and one with mean and standard deviation of each tactor.
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

json list_calibrations(const study_facts& f)
{
    json all = json::array();
    for (const session_facts& s : f.sessions) {
        const json_value c = s.facts()["calibration"];
        if (!c.exists())
            continue;
        json row{{"code", s.code}};
        for (const char* key : {"participant", "method", "rule", "carrier_hz", "interval_s", "feedback",
                                "masker", "date", "simulated", "warnings"})
            row[key] = c[key].words();
        all.push_back(row);
    }
    return all;
}

// Cuts the intervals of means to the values that a mean may have: one from t knows no bounds.
void cut_intervals(json& results, const interval& possible)
{
    if (const auto ci = results.find("ci"); ci != results.end() && ci->is_array())
        for (json& end : *ci)
            end = std::clamp(end.get<double>(), possible.first, possible.second);
    for (json& inner : results)
        if (inner.is_object())
            cut_intervals(inner, possible);
}

// Returns a result as methods.md has it, under the name of its kind.
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
        cut_intervals(all_, v.possible);
    }
    void operator()(const interval_share&) { kind_ = "first_interval"; }
    void operator()(const method_difference&) { kind_ = "paired"; }
    void operator()(const effect_list&) { kind_ = "anova"; }
    void operator()(const tukey_list&) { set_rows("tukey"); }
    void operator()(const paired_list&) { set_rows("pairs"); }
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
    // Only the main figure is tested, if there is something against which.
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
    void operator()(const exponents&) { kind_ = "exponent"; }

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
             {"left_out", left_out_json(r.missing)},
             {"rows", json::array()},
             {"response_time", times_json(r.times)}};
    for (const result& row : r.results)
        if (r.n != 0 && has_table(row.value))
            run["rows"].push_back(row_facts(row).finish());
    return run;
}

} // namespace

nlohmann::ordered_json collect_facts(const study_facts& f, const dataset& d, const analysis& a)
{
    std::set<std::string_view> sections;
    for (const run_outline& r : d.experiment.runs)
        for (const std::string_view section : task_in(r).list_sections(r))
            sections.insert(section);
    const auto definition = [&f](const std::function<std::string(const experiment_definition&)>& text) {
        return join_texts(f,
                          [&](const session_facts& s) { return s.design ? text(*s.design) : std::string(); });
    };
    const auto fact = [&f](const char* key) {
        return join_texts(f, [key](const session_facts& s) { return fact_text(s, key); });
    };
    std::vector<std::string> codes;
    for (const participant& p : f.people)
        codes.push_back(p.code);
    json all{{"version", std::string(version())}, {"experiment", d.experiment.name}};
    all["title"] =
        join_texts(f, [&](const session_facts& s) { return s.design ? s.design->title : d.experiment.name; });
    all["simulation"] = d.simulated ? json{{"how", fact("simulation")}} : json(false);
    all["participants"] = fmt::format("{}: {}", counted(codes.size(), "participant"), list_subjects(codes));
    all["age"] = ages_text(f);
    all["sex"] = counts_text(f, &participant::sex);
    all["handedness"] = counts_text(f, &participant::handedness);
    all["array"] = join_texts(f, describe_array);
    for (const char* key : {"rate", "channels", "device", "sound_server"})
        all[key] = fact(key);
    all["arrays"] = list_arrays(f);
    const bool coded =
        std::ranges::any_of(f.sessions, [](const session_facts& s) { return s.facts()["codes"].exists(); });
    all["codes"] = coded ? json(join_texts(f, codes_text)) : json(false);
    const std::string acceleration = join_texts(f, acceleration_text);
    all["acceleration"] = acceleration == not_recorded ? json(false) : json(acceleration);
    all["level"] = join_texts(f, describe_level);
    all["assumed"] = join_texts(f, assumed_text);
    all["thresholds"] = tabulate_thresholds(f);
    all["calibrations"] = list_calibrations(f);
    all["calibrated"] = !all["calibrations"].empty();
    all["carrier"] = join_texts(f, describe_carrier);
    all["bursts"] = std::ranges::any_of(f.sessions, has_bursts);
    all["law"] = join_texts(f, law_text);
    all["methods"] = list_methods(f);
    json& equations = all["equations"] = json::object(); // by names from files
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            for (const char* key : {"algorithm", "phantom"})
                equations[p.facts()[key].need_text()] = true;
    all["stimuli"] = list_stimuli(f);
    all["recorded"] = !all["stimuli"].empty();
    all["valued"] = std::ranges::any_of(all["stimuli"], [](const json& s) { return s.at("value") != ""; });
    all["notes"] = list_notes(f);
    all["gap"] =
        std::ranges::any_of(f.sessions,
                            [](const session_facts& s) {
                                return s.design &&
                                       std::ranges::any_of(s.design->runs, &run_definition::pairs);
                            })
            ? json(definition([](const experiment_definition& e) { return plain_number(e.gap_s) + " s"; }))
            : json(false);
    all["rest"] = definition([](const experiment_definition& e) {
        return e.rest.is_random() ? fmt::format("{} to {} s, drawn for each trial",
                                                plain_number(e.rest.least_s), plain_number(e.rest.most_s))
                                  : describe_pause(e.rest.least_s);
    });
    all["order"] = definition([](const experiment_definition& e) {
        if (e.order == "random")
            return std::string("random, drawn for each participant");
        return fmt::format("a row of a {}, chosen by the participant's code or by the experimenter",
                           e.order == "latin" ? "cyclic Latin square" : "Williams square (Williams 1949)");
    });
    all["several"] = d.experiment.sessions > 1
                         ? json{{"number", d.experiment.sessions}, {"between", between_text(f)}}
                         : json(false);
    all["groups"] = json::array();
    for (const group_outline& g : d.experiment.groups)
        all["groups"].push_back({{"name", g.name}, {"runs", describe_group(g)}});
    all["grouped"] = !d.experiment.groups.empty();
    all["runs"] = json::array();
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i)
        all["runs"].push_back(describe_run(f, d.experiment.runs[i], i));
    all["questionnaires"] = list_questionnaires(f);
    const bool own =
        std::ranges::any_of(f.sessions, [](const session_facts& s) { return s.design.has_value(); });
    for (const session_facts& s : f.sessions)
        if (s.design)
            for (const run_definition& r : s.design->runs) {
                std::string_view section;
                task_in(r.outline).describe_procedure(r, section);
                sections.insert(section);
            }
    for (const std::string_view section : sections)
        all[std::string(section)] = true;
    all["ordered"] = own;
    all["sessions"] = json::array();
    for (const session_facts& s : f.sessions)
        all["sessions"].push_back(describe_session(s));
    all["held"] = !f.sessions.empty();
    all["versions"] = join_texts(f, [](const session_facts& s) {
        const json_value v = s.facts()["versions"];
        return v["build"].exists() ? fmt::format("{} ({})", v["tactor"].words(), v["build"].words())
                                   : v["tactor"].words();
    });
    all["definitions"] = join_texts(f, [](const session_facts& s) { return s.definition_hash; });
    all["excluded"] = left_out_json(d.excluded);
    all["results"] = json::array();
    for (const run_analysis& r : a.runs)
        all["results"].push_back(describe_results(r));
    all["warnings"] = a.warnings;
    for (const std::string& w : a.no_figures)
        all["warnings"].push_back(w);
    return all;
}

std::string name_subjects(const study_facts& f, const std::vector<std::string>& codes)
{
    return codes.size() == f.sessions.size() ? "all" : list_subjects(codes);
}

std::string fact_text(const session_facts& s, const std::string& key)
{
    if (!s.document.contains(key))
        return not_recorded;
    const std::string words = s.facts()[key].words();
    return words.empty() ? "none" : words;
}

std::string join_texts(const study_facts& f, const std::function<std::string(const session_facts&)>& text)
{
    shared_facts<std::string> texts;
    for (const session_facts& s : f.sessions) {
        const std::string own = text(s);
        add_fact(texts, own.empty() ? not_recorded : own, s.code);
    }
    std::vector<std::string> parts;
    for (const auto& [own, codes] : texts)
        parts.push_back(texts.size() == 1 ? own : fmt::format("{} ({})", own, list_subjects(codes)));
    return parts.empty() ? not_recorded : join(parts, "; ");
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
