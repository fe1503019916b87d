// SPDX-License-Identifier: MIT
#include "study/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/render.hpp>
#include <tactor/version.hpp>

#include "core/split.hpp"
#include "core/words.hpp"
#include "options/option.hpp"
#include "study/analysis/analysis.hpp"
#include "study/experiment/trials.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

constexpr const char* not_recorded = "not recorded";

template <class Texts>
std::string join(const Texts& texts, std::string_view between = ", ")
{
    return fmt::format("{}", fmt::join(texts, between));
}

std::string list_subjects(const std::vector<std::string>& codes)
{
    return "sub-" + join(codes, ", sub-");
}

// Returns "all" for a fact of everybody.
std::string name_subjects(const study_facts& f, const std::vector<std::string>& codes)
{
    return codes.size() == f.sessions.size() ? "all" : list_subjects(codes);
}

// Facts in the order in which they came, each with the sessions that have it.
template <class Fact>
using shared_facts = std::vector<std::pair<Fact, std::vector<std::string>>>;

template <class Fact>
void add_fact(shared_facts<Fact>& all, const Fact& fact, const std::string& code)
{
    auto at = std::find_if(all.begin(), all.end(), [&](const auto& f) { return f.first == fact; });
    if (at == all.end())
        at = all.emplace(at, fact, std::vector<std::string>());
    if (at->second.empty() || at->second.back() != code) // two stimuli of a session may be the same
        at->second.push_back(code);
}

bool is_simulated(const session_facts& s)
{
    return s.facts()["simulated"].truth().value_or(false);
}

// Returns a fact of a session in words: "none" where it is null.
std::string fact_text(const session_facts& s, const std::string& key)
{
    if (!s.document.contains(key))
        return not_recorded;
    const std::string words = s.facts()[key].words();
    return words.empty() ? "none" : words;
}

// Returns what the openings of the device have under a key, each once.
std::string stream_text(const session_facts& s, const std::string& key)
{
    std::set<std::string> seen;
    for (const json_value& one : s.facts()["streams"].list())
        seen.insert(one[key].there() ? one[key].words() : "none");
    if (seen.empty())
        return is_simulated(s) ? "simulated" : not_recorded;
    return join(seen, "; ");
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

// Counts the values of a column.
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
    return a.there() ? fmt::format("{}, {}", a["name"].words(), counted(a["tactors"].list().size(), "tactor"))
                     : "";
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

// Returns the acceleration that the measured displacement is at each carrier; empty if none was measured.
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

// Describes the experiment's level, and then those of the methods that have their own.
std::string describe_level(const session_facts& s)
{
    const json_value level = s.facts()["level"];
    std::string text;
    if (const auto sl = level["sl_db"].number())
        text = fmt::format("{0} dB above each tactor's detection threshold ({0} dB SL)", plain_number(*sl));
    else if (const auto dbfs = level["dbfs"].number())
        text = fmt::format("{} dBFS, the same for all tactors but for their gains", plain_number(*dbfs));
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
    const bool used = s.design ? uses_thresholds(*s.design) : !s.facts()["level"]["dbfs"].there();
    return !assumed   ? ""
           : !used    ? "not used: the level is in dBFS"
           : *assumed ? "assumed, not measured, for tactors without one"
                      : "from the array file, none assumed";
}

// Returns a threshold, or those at several frequencies.
std::string describe_threshold(const json_value& t)
{
    if (!t.is_list())
        return t.there() ? plain_number(t.need_number()) : "none";
    std::vector<std::string> parts;
    for (const json_value& pair : t.list()) {
        const std::vector<double> hz_and_dbfs = pair.need_numbers();
        if (hz_and_dbfs.size() != 2)
            pair.refuse("is no frequency with a threshold");
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
        if (std::none_of(all.begin(), all.end(), [](const json_value& t) { return t.there(); }))
            continue;
        columns.resize(std::max(columns.size(), all.size()));
        for (const json_value& t : all) {
            if (t.there() && !t.is_list())
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
        if (!c.there())
            continue;
        json row{{"code", s.code}};
        for (const char* key : {"participant", "method", "rule", "carrier_hz", "interval_s", "feedback",
                                "masker", "date", "simulated", "warnings"})
            row[key] = c[key].words();
        all.push_back(row);
    }
    return all;
}

// Lists the different texts about the plans of a session.
template <class F>
std::string join_plans(const session_facts& s, const F& text, const char* between = ", ")
{
    std::set<std::string> seen;
    for (const planned_stimulus& p : s.stimuli)
        seen.insert(text(p));
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
std::string describe_sound(const planned_stimulus& p)
{
    const json_value plan = p.facts();
    const json_value stroke = plan["stroke"];
    std::string text = stroke["waveform"].text().value_or("sine");
    for (const char* key :
         {"carrier_hz", "noise_seed", "am_hz", "am_depth", "texture", "texture_mm", "course"})
        if (stroke[key].there())
            text += fmt::format(", {} {}", key, stroke[key].words());
    text += fmt::format(", phase {}", plan["render"]["phase"].words());
    const json_value envelope = plan["render"]["envelope"];
    text += envelope.there() ? ", envelope " + envelope.words() : ", raised-cosine ramps";
    for (const json_value& t : plan["array"]["tactors"].list())
        if (t["rise_s"].there())
            text += fmt::format(", tactor {} rises in {} s", t["tactor"].words(), t["rise_s"].words());
    return text;
}

std::string describe_carrier(const session_facts& s)
{
    std::vector<double> ramps;
    for (const planned_stimulus& p : s.stimuli)
        for (const double ramp_s : list_burst_numbers(p.facts(), "ramp_s"))
            ramps.push_back(ramp_s);
    return s.stimuli.empty() ? ""
                             : fmt::format("{}; ramps of {} s at both ends of a burst",
                                           join_plans(s, describe_sound, "; "), range_text(ramps));
}

std::string law_text(const session_facts& s)
{
    std::set<std::string> laws;
    if (s.design)
        for (const method_definition& m : s.design->methods)
            laws.insert(fmt::format("$\\mathrm{{SOA}} = {}\\,d + {}\\,\\mathrm{{s}}$ with burst duration $d$",
                                    plain_number(m.options.plan.profile.slope),
                                    plain_number(m.options.plan.profile.intercept_s)));
    return join(laws, " and ");
}

// Lists the methods in the order in which they came.
json list_methods(const study_facts& f)
{
    std::vector<std::string> names;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            if (std::find(names.begin(), names.end(), p.method) == names.end())
                names.push_back(p.method);
    json all = json::array();
    for (const std::string& name : names) {
        const auto kinds = [&](const char* key) {
            return join_texts(f, [&](const session_facts& s) {
                return join_plans(s, [&](const planned_stimulus& p) {
                    return p.method == name ? p.facts()[key].words() : "";
                });
            });
        };
        const std::string options = join_texts(f, [&](const session_facts& s) -> std::string {
            if (s.design)
                for (const method_definition& m : s.design->methods)
                    if (m.name == name)
                        return method_options(m.options);
            return "";
        });
        all.push_back({{"name", name},
                       {"algorithm", kinds("algorithm")},
                       {"phantom", kinds("phantom")},
                       {"options", options}});
    }
    return all;
}

json describe_stimulus(const planned_stimulus& p)
{
    const json_value plan = p.facts();
    const auto number = [](const json_value& v) { return v.there() ? plain_number(v.need_number()) : "-"; };
    const std::vector<double> bursts_s = list_burst_numbers(plan, "duration_s");
    return {{"motion", p.motion},
            {"method", p.method},
            {"path", plan["stroke"]["name"].words()},
            {"target_s", number(plan["stroke"]["duration_s"])},
            {"length_mm", number(plan["stroke"]["length_mm"])},
            {"soa_s", number(plan["soa_s"])},
            {"bursts", bursts_s.empty() ? "continuous"
                                        : fmt::format("{} of {} s", bursts_s.size(), range_text(bursts_s))},
            {"total_s", number(plan["total_s"])},
            {"overlaps", plan["conflicts"].list().size()},
            {"hash", p.hash}};
}

json list_stimuli(const study_facts& f)
{
    shared_facts<json> rows;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            add_fact(rows, describe_stimulus(p), s.code);
    json all = json::array();
    for (const auto& [row, codes] : rows) {
        all.push_back(row);
        all.back()["who"] = name_subjects(f, codes);
    }
    return all;
}

// Lists what is noted of motions, and what the planner warned of.
std::set<std::string> list_notes(const study_facts& f)
{
    std::set<std::string> notes;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli) {
            if (const std::string note = p.facts()["stroke"]["note"].words(); !note.empty())
                notes.insert(fmt::format("{}: {}", p.motion, note));
            for (const json_value& w : p.facts()["warnings"].list())
                notes.insert(fmt::format("{} by {}: {}", p.motion, p.method, w.need_text()));
        }
    return notes;
}

// Describes a task that measures, with the values.
std::string describe_measure(const run_outline& r)
{
    std::string text = fmt::format("{} ({})", find_task(r.task).trial, join(r.methods));
    if (!r.vary.empty())
        text += fmt::format(
            "; {} {} {}", r.vary, r.task == task_kind::adaptive ? "chosen by the answers from" : "of",
            r.task == task_kind::adaptive
                ? fmt::format("{} to {}", plain_number(r.values.front()), plain_number(r.values.back()))
                : join(r.values));
    if (r.standard)
        text += fmt::format("; standard {}", plain_number(*r.standard));
    return text + (r.catches ? "; some trials without a stimulus" : "");
}

std::string describe_task(const run_outline& r)
{
    const std::string methods = join(r.methods);
    if (r.task == task_kind::choose)
        return fmt::format("two stimuli of one motion, by {}, one after the other; one was chosen",
                           has_worths(r) ? "two of " + methods : join(r.methods, " and by "));
    if (r.task == task_kind::rate)
        return fmt::format("one stimulus ({}), rated from {}", methods, rating_range(r));
    if (r.task == task_kind::identify)
        return fmt::format("one stimulus ({}); one of {} was named", methods,
                           counted(r.motions.size(), "motion"));
    return describe_measure(r);
}

std::string describe_pause(double s)
{
    return s > 0.0 ? plain_number(s) + " s" : "none";
}

json describe_run(const study_facts& f, const run_outline& o, std::size_t run)
{
    const auto fact = [&](const std::function<std::string(const run_definition&)>& text) {
        return join_texts(f, [&](const session_facts& s) {
            return s.design ? text(s.design->runs.at(run)) : std::string();
        });
    };
    return {
        {"name", o.name},
        {"task", to_string(o.task)},
        {"asked", describe_task(o)},
        {"motions", join(o.motions)},
        {"attribute", fact([](const run_definition& r) { return r.attribute; })},
        {"question", fact([](const run_definition& r) { return r.question; })},
        {"animation", join_texts(f,
                                 [run](const session_facts& s) {
                                     if (!s.design)
                                         return std::string();
                                     return s.design->runs.at(run).animation ? stream_text(s, "display")
                                                                             : std::string("no");
                                 })},
        {"trials", o.trials == 0 ? not_recorded : fmt::format("{}", o.trials)},
        {"practice", fact([](const run_definition& r) { return fmt::format("{}", r.practice); })},
        {"labels", fact([](const run_definition& r) { return r.labels.empty() ? "none" : join(r.labels); })},
        {"choices",
         fact([](const run_definition& r) { return r.choices.empty() ? "none" : join(r.choices); })},
        {"blocks", fact([](const run_definition& r) {
             return r.blocks.empty() ? "none" : fmt::format("the {}, ordered like the runs", r.blocks);
         })},
        {"break", fact([](const run_definition& r) { return describe_pause(r.break_s); })},
        {"early", fact([](const run_definition& r) { return plain_number(r.min_response_s) + " s"; })}};
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

// Returns what was so in a session, with the trials of each run that count, void ones, and those of them with
// gaps in the sound.
json describe_session(const session_facts& s)
{
    json row{
        {"code", s.code}, {"days", days_text(s)}, {"mirrored", mirrored_text(s)}, {"walk", walk_text(s)}};
    for (const char* key : {"group", "order", "seed", "hand"})
        row[key] = fact_text(s, key);
    if (const json_value at = s.facts()["order_row"]; at.there())
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

// Cuts the intervals of means to the values that a mean may have: one from t knows no bounds.
void cut_intervals(json& results, double low, double high)
{
    if (const auto ci = results.find("ci"); ci != results.end() && ci->is_array())
        for (json& end : *ci)
            end = std::clamp(end.get<double>(), low, high);
    for (json& inner : results)
        if (inner.is_object())
            cut_intervals(inner, low, high);
}

// Adds the rows of a table of worths.
void add_rows(json& bradley_terry)
{
    json rows = json::array();
    for (const auto& [method, log_worth] : bradley_terry.at("log_worth").items())
        rows.push_back(
            {{"name", method}, {"log_worth", log_worth}, {"se", bradley_terry.at("se").at(method)}});
    bradley_terry["rows"] = std::move(rows);
}

// Adds the results of the groups, named like runs. Returns the outlines of all results.
std::vector<run_outline> add_groups(json& runs, const experiment_outline& e)
{
    std::vector<run_outline> all = e.runs;
    for (const group_outline& g : e.groups)
        for (const run_outline& o : g.runs) {
            if (o.motions.empty())
                continue; // the group lacks the run
            const json results = runs.at(o.name).at("groups").at(g.name);
            all.push_back(o);
            all.back().name = name_result(o.name, g.name);
            runs[all.back().name] = results;
        }
    return all;
}

// Adds to each run what its tables need: names of motions, and lists of Tukey's comparisons.
json describe_results(json runs, const dataset& d)
{
    for (const run_outline& o : add_groups(runs, d.experiment)) {
        json& run = runs.at(o.name);
        if (run.at("n") == 0) // nobody answered all of it
            for (const char* key : {"preference", "chosen", "first_interval", "bradley_terry", "means",
                                    "paired", "anova", "tukey", "correct", "confusion", "pairs"})
                run.erase(key);
        const interval possible = possible_values(o);
        for (const char* key : {"preference", "chosen", "means", "correct"})
            if (run.contains(key))
                cut_intervals(run[key], possible.first, possible.second);
        if (run.contains("bradley_terry"))
            add_rows(run["bradley_terry"]);
        run["motions"] = o.motions;
        run["compared"] = json::array();
        const auto add = [&run](const json& within, const json& rows) {
            if (!rows.empty() && !rows[0].at("q").is_null())
                run["compared"].push_back({{"within", within}, {"rows", rows}});
        };
        const json tukey = run.value("tukey", json::array());
        if (tukey.is_array())
            add(nullptr, tukey);
        else
            for (const auto& [method, rows] : tukey.items())
                add(method, rows);
    }
    return runs;
}

} // namespace

nlohmann::ordered_json collect_facts(const study_facts& f, const dataset& d, const json& analysis)
{
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
    const std::string acceleration = join_texts(f, acceleration_text);
    all["acceleration"] = acceleration == not_recorded ? json(false) : json(acceleration);
    all["level"] = join_texts(f, describe_level);
    all["assumed"] = join_texts(f, assumed_text);
    all["thresholds"] = tabulate_thresholds(f);
    all["calibrations"] = list_calibrations(f);
    all["calibrated"] = !all["calibrations"].empty();
    all["carrier"] = join_texts(f, describe_carrier);
    all["law"] = join_texts(f, law_text);
    all["methods"] = list_methods(f);
    json& equations = all["equations"] = json::object(); // by names from files
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            for (const char* key : {"algorithm", "phantom"})
                equations[p.facts()[key].need_text()] = true;
    all["stimuli"] = list_stimuli(f);
    all["recorded"] = !all["stimuli"].empty();
    all["notes"] = list_notes(f);
    all["gap"] = definition([](const experiment_definition& e) { return plain_number(e.gap_s) + " s"; });
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
    all["worths"] = std::ranges::any_of(d.experiment.runs, has_worths);
    all["most_in_a_row"] = own ? json(fmt::format("{}", most_in_a_row)) : json(false);
    all["sessions"] = json::array();
    for (const session_facts& s : f.sessions)
        all["sessions"].push_back(describe_session(s));
    all["held"] = !f.sessions.empty();
    all["versions"] = join_texts(f, [](const session_facts& s) {
        const json_value v = s.facts()["versions"];
        return v["build"].there() ? fmt::format("{} ({})", v["tactor"].words(), v["build"].words())
                                  : v["tactor"].words();
    });
    all["definitions"] = join_texts(f, [](const session_facts& s) { return s.definition_hash; });
    all["excluded"] = json::array();
    for (const left_out& one : d.excluded)
        all["excluded"].push_back({{"participant", one.participant}, {"why", one.why}});
    all["results"] = describe_results(analysis.at("runs"), d);
    all["warnings"] = analysis.at("warnings");
    return all;
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

std::string method_options(const options::wishes& o)
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
