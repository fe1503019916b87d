// SPDX-License-Identifier: MIT
#include "study/analysis/analysis_json.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "files/json/json_value.hpp"

namespace tactor::study {
namespace {

using files::or_null;
using json = nlohmann::ordered_json;

json interval_json(const std::optional<interval>& i)
{
    return i ? json::array({i->first, i->second}) : json(nullptr);
}

json mean_json(const t_test& t)
{
    return {{"mean", or_null(t.mean)},
            {"se", or_null(t.se)},
            {"ci", interval_json(t.ci)},
            {"ci_within", interval_json(t.ci_within)}};
}

json test_json(const t_test& t)
{
    json j = mean_json(t);
    j.update({{"t", or_null(t.t)},
              {"df", or_null(t.df)},
              {"p", or_null(t.p)},
              {"p_signflip", or_null(t.p_signflip)},
              {"d", or_null(t.d)},
              {"d_ci", interval_json(t.d_ci)}});
    return j;
}

// Returns a measure over all motions and for each, with its tests or without.
json cells_json(const by_motion& b, const std::vector<std::string>& motions, bool tested)
{
    const auto cell = tested ? test_json : mean_json;
    json j{{"all", cell(b.all)}, {"motion", json::object()}};
    for (std::size_t m = 0; m < motions.size(); ++m) {
        json& one = j["motion"][motions[m]] = cell(b.motion[m]);
        if (tested)
            one["p_holm"] = or_null(b.p_holm[m]);
    }
    return j;
}

// Null for a factor with one level, which has no effect.
json effect_json(const effect& e, std::size_t levels)
{
    if (levels < 2)
        return nullptr;
    const auto df = [&](double v) { return v > 0.0 ? json(v) : json(nullptr); };
    return {{"F", or_null(e.f)},
            {"df1", df(e.df1)},
            {"df2", df(e.df2)},
            {"p", or_null(e.p)},
            {"epsilon_gg", or_null(e.epsilon_gg)},
            {"p_gg", or_null(e.p_gg)},
            {"epsilon_hf", or_null(e.epsilon_hf)},
            {"p_hf", or_null(e.p_hf)},
            {"mauchly_w", or_null(e.mauchly_w)},
            {"mauchly_p", or_null(e.mauchly_p)},
            {"eta2_partial", or_null(e.eta2_partial)},
            {"eta2_generalised", or_null(e.eta2_generalised)}};
}

json pairs_json(const std::vector<comparison>& pairs, const std::vector<std::string>& motions)
{
    json j = json::array();
    for (const comparison& c : pairs)
        j.push_back({{"a", motions[c.a]},
                     {"b", motions[c.b]},
                     {"difference", c.difference},
                     {"q", or_null(c.q)},
                     {"p", or_null(c.p)}});
    return j;
}

json first_interval_json(const t_test& t)
{
    return {{"mean", or_null(t.mean)}, {"t", or_null(t.t)}, {"p", or_null(t.p)}};
}

void add_worths(json& j, const run_analysis& r)
{
    j["chosen"] = json::object();
    json log_worth = json::object();
    json se = json::object();
    for (std::size_t m = 0; m < r.run.methods.size(); ++m) {
        const std::string& method = r.run.methods[m];
        j["chosen"][method] = cells_json(r.cells[m], r.run.motions, true);
        log_worth[method] = or_null(r.worths[m].log_worth);
        se[method] = or_null(r.worths[m].se);
    }
    j["first_interval"] = first_interval_json(r.first_interval);
    j["bradley_terry"] = {{"log_worth", log_worth}, {"se", se}, {"reference", r.run.methods.front()}};
}

json paired_json(const std::vector<paired_comparison>& pairs, const std::vector<std::string>& motions)
{
    json j = json::array();
    for (const paired_comparison& c : pairs)
        j.push_back({{"a", motions[c.a]},
                     {"b", motions[c.b]},
                     {"difference", or_null(c.test.mean)},
                     {"t", or_null(c.test.t)},
                     {"df", or_null(c.test.df)},
                     {"p", or_null(c.test.p)},
                     {"p_holm", or_null(c.p_holm)}});
    return j;
}

void add_choose(json& j, const run_analysis& r)
{
    if (has_worths(r.run)) {
        add_worths(j, r);
        return;
    }
    const std::vector<std::string>& motions = r.run.motions;
    j["method"] = r.run.methods.back();
    j["preference"] = cells_json(r.cells[0], motions, true);
    j["first_interval"] = first_interval_json(r.first_interval);
    j["anova"] = {{"motion", effect_json(r.effects.second, motions.size())}};
    j["tukey"] = pairs_json(r.pairs[0], motions);
}

void add_rate(json& j, const run_analysis& r)
{
    const std::vector<std::string>& motions = r.run.motions;
    const std::vector<std::string>& methods = r.run.methods;
    j["means"] = json::object();
    for (std::size_t m = 0; m < methods.size(); ++m)
        j["means"][methods[m]] = cells_json(r.cells[m], motions, false);
    const t_test& t = r.paired;
    j["paired"] = methods.size() < 2 ? json(nullptr)
                                     : json{{"difference", or_null(t.mean)},
                                            {"ci", interval_json(t.ci)},
                                            {"t", or_null(t.t)},
                                            {"df", or_null(t.df)},
                                            {"p", or_null(t.p)},
                                            {"p_signflip", or_null(t.p_signflip)},
                                            {"d_z", or_null(t.d)},
                                            {"d_z_ci", interval_json(t.d_ci)}};
    j["anova"] = {
        {"method", effect_json(r.effects.first, methods.size())},
        {"motion", effect_json(r.effects.second, motions.size())},
        {"method:motion", effect_json(r.effects.interaction, std::min(methods.size(), motions.size()))}};
    j["tukey"] = json::object();
    for (std::size_t m = 0; m < methods.size(); ++m)
        j["tukey"][methods[m]] = pairs_json(r.pairs[m], motions);
}

void add_identify(json& j, const run_analysis& r)
{
    j["chance"] = chance(r.run);
    j["confusion"] = json::object();
    j["correct"] = json::object();
    j["pairs"] = json::object();
    for (std::size_t m = 0; m < r.run.methods.size(); ++m) {
        json matrix = json::object();
        for (std::size_t i = 0; i < r.run.motions.size(); ++i) {
            json row = json::object();
            for (std::size_t k = 0; k < r.run.motions.size(); ++k)
                row[r.run.motions[k]] = r.confusion[m][i][k];
            matrix[r.run.motions[i]] = std::move(row);
        }
        j["confusion"][r.run.methods[m]] = std::move(matrix);
        j["correct"][r.run.methods[m]] = cells_json(r.cells[m], r.run.motions, true);
        j["pairs"][r.run.methods[m]] = paired_json(r.paired_motions[m], r.run.motions);
    }
}

json psychometric_json(const run_analysis& r, const measured_condition& c)
{
    json people = json::object();
    for (std::size_t i = 0; i < r.codes.size(); ++i) {
        const person_measures& m = c.people[i];
        json blocks = json::array();
        for (const answer_block& b : m.blocks)
            blocks.push_back({{"value", b.x}, {"n", b.n}, {"positive", b.k}});
        people[r.codes[i]] = {{"alpha", m.fit ? json(m.fit->parameters.threshold) : json(nullptr)},
                              {"beta", m.fit ? json(m.fit->parameters.slope) : json(nullptr)},
                              {"lapse", m.fit ? json(m.fit->parameters.lapse) : json(nullptr)},
                              {"guess", m.guess},
                              {"pse", or_null(m.pse)},
                              {"jnd", or_null(m.jnd)},
                              {"threshold", m.fit ? json(m.fit->parameters.threshold) : json(nullptr)},
                              {"ci",
                               {{"pse", interval_json(m.pse ? m.bootstrap.threshold : std::nullopt)},
                                {"jnd", interval_json(m.jnd_ci)},
                                {"threshold", interval_json(m.bootstrap.threshold)}}},
                              {"deviance", m.fit ? json(m.fit->deviance) : json(nullptr)},
                              {"p_gof", or_null(m.bootstrap.p_gof)},
                              {"answers", std::move(blocks)}};
    }
    json j{{"function", r.function == sigmoid::normal ? "normal" : "logistic"},
           {"axis", r.run.on_db_axis ? "dB" : "linear"},
           {"participants", std::move(people)},
           {"mean", json::object()}};
    for (const auto& [figure, t] : c.figures)
        if (figure != "dprime" && figure != "c") {
            j["mean"][std::string(figure)] = or_null(t.mean);
            j["tests"][std::string(figure)] = test_json(t);
        }
    return j;
}

json dprime_json(const measured_condition& c, const std::vector<std::string>& codes)
{
    json people = json::object();
    for (std::size_t i = 0; i < codes.size(); ++i)
        if (const auto& d = c.people[i].detected)
            people[codes[i]] = {{"hits", d->hits},
                                {"false_alarms", d->false_alarms},
                                {"dprime", d->found.dprime},
                                {"c", d->found.c}};
    json j{{"participants", std::move(people)}};
    for (const auto& [figure, t] : c.figures)
        if (figure == "dprime")
            j.update(test_json(t));
    j["likelihood_ratio"] = nullptr;
    if (const auto& d = c.difference)
        j["likelihood_ratio"] = {{"value", d->likelihood_ratio}, {"p", d->p}, {"studies", d->studies}};
    return j;
}

json exponent_json(const measured_condition& c, const std::vector<std::string>& codes)
{
    json people = json::object();
    for (std::size_t i = 0; i < codes.size(); ++i)
        people[codes[i]] = or_null(c.people[i].exponent);
    json j{{"participants", std::move(people)}};
    j.update(test_json(c.figures.front().second));
    return j;
}

// Adds the results of a task that measures; those of each condition under "by".
void add_measures(json& j, const run_analysis& r)
{
    const auto add = [&](json& to, const measured_condition& c) {
        if (r.run.task == task_kind::estimate)
            to["exponent"] = exponent_json(c, r.codes);
        else if (r.run.task != task_kind::same_different)
            to["psychometric"] = r.run.vary.empty() ? json(nullptr) : psychometric_json(r, c);
        if (r.run.task == task_kind::same_different || r.run.task == task_kind::detect)
            to["dprime"] =
                r.run.task == task_kind::detect && !r.run.catches ? json(nullptr) : dprime_json(c, r.codes);
    };
    j["vary"] = r.run.vary.empty() ? json(nullptr) : json(r.run.vary);
    j["against"] = or_null(measured_against(r.run));
    for (const measured_condition& c : r.measures)
        add(c.name.empty() ? j : j["by"][c.name], c);
}

json times_json(const response_times& t)
{
    json j{{"median_s", or_null(t.median_s)}, {"by", json::object()}};
    for (const auto& [condition, median_s] : t.by)
        j["by"][condition] = or_null(median_s);
    return j;
}

json run_json(const run_analysis& r)
{
    json j{{"task", to_string(r.run.task)}, {"n", r.n}};
    switch (r.run.task) {
    case task_kind::choose:
        add_choose(j, r);
        break;
    case task_kind::rate:
        add_rate(j, r);
        break;
    case task_kind::identify:
        add_identify(j, r);
        break;
    default:
        add_measures(j, r);
        break;
    }
    for (const auto& [name, e] : list_group_effects(r))
        j["group_anova"][name] = e != nullptr ? effect_json(*e, 2) : json(nullptr);
    j["trials"] = r.trials;
    j["early"] = r.early;
    j["response_time"] = times_json(r.times);
    j["left_out"] = json::array();
    for (const left_out& l : r.missing)
        j["left_out"].push_back({{"participant", l.participant}, {"why", l.why}});
    return j;
}

} // namespace

nlohmann::ordered_json make_analysis_json(const analysis& a)
{
    json j{{"schema", "tactor-analysis/1"}, {"experiment", a.experiment}, {"participants", a.participants},
           {"simulated", a.simulated},      {"runs", json::object()},     {"void", json::object()}};
    for (const run_analysis& r : a.runs)
        if (r.group.empty()) {
            j["runs"][r.whole] = run_json(r);
            j["void"][r.whole] = r.voids;
        } else
            j["runs"][r.whole]["groups"][r.group] = run_json(r);
    j["warnings"] = a.warnings;
    for (const std::string& w : a.no_figures)
        j["warnings"].push_back(w);
    return j;
}

} // namespace tactor::study
