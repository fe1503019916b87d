// SPDX-License-Identifier: MIT
#include "study/results/result_json.hpp"

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "files/json/json_value.hpp"
#include "study/tasks/task.hpp"

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

json to_json(std::monostate)
{
    return nullptr;
}

json to_json(const std::string& v)
{
    return v;
}

json to_json(double v)
{
    return v;
}

json to_json(const cell_means& v)
{
    const auto cell = v.against ? test_json : mean_json;
    json j{{"all", cell(v.means.front().test)}, {"motion", json::object()}};
    for (std::size_t m = 1; m < v.means.size(); ++m) {
        json& one = j["motion"][v.means[m].name] = cell(v.means[m].test);
        if (v.against)
            one["p_holm"] = or_null(v.means[m].p_holm);
    }
    return j;
}

json to_json(const interval_share& v)
{
    return {{"mean", or_null(v.test.mean)}, {"t", or_null(v.test.t)}, {"p", or_null(v.test.p)}};
}

json to_json(const method_difference& v)
{
    const t_test& t = v.test;
    return {{"difference", or_null(t.mean)},
            {"ci", interval_json(t.ci)},
            {"t", or_null(t.t)},
            {"df", or_null(t.df)},
            {"p", or_null(t.p)},
            {"p_signflip", or_null(t.p_signflip)},
            {"d_z", or_null(t.d)},
            {"d_z_ci", interval_json(t.d_ci)}};
}

json effect_json(const effect& e)
{
    const auto df = [](double v) { return v > 0.0 ? json(v) : json(nullptr); };
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

json to_json(const effect_list& v)
{
    json j = json::object();
    for (const auto& [name, e] : v.effects)
        j[name] = e ? effect_json(*e) : json(nullptr);
    return j;
}

json to_json(const tukey_list& v)
{
    json j = json::array();
    for (const comparison& c : v.pairs)
        j.push_back({{"a", v.motions[c.a]},
                     {"b", v.motions[c.b]},
                     {"difference", c.difference},
                     {"q", or_null(c.q)},
                     {"p", or_null(c.p)}});
    return j;
}

json to_json(const paired_list& v)
{
    json j = json::array();
    for (const paired_comparison& c : v.pairs)
        j.push_back({{"a", v.motions[c.a]},
                     {"b", v.motions[c.b]},
                     {"difference", or_null(c.test.mean)},
                     {"t", or_null(c.test.t)},
                     {"df", or_null(c.test.df)},
                     {"p", or_null(c.test.p)},
                     {"p_holm", or_null(c.p_holm)}});
    return j;
}

json to_json(const worth_list& v)
{
    json j{{"log_worth", json::object()}, {"se", json::object()}, {"reference", v.methods.front()}};
    for (std::size_t m = 0; m < v.methods.size(); ++m) {
        j["log_worth"][v.methods[m]] = or_null(v.worths[m].log_worth);
        j["se"][v.methods[m]] = or_null(v.worths[m].se);
    }
    return j;
}

json to_json(const answer_counts& v)
{
    json j = json::object();
    for (std::size_t i = 0; i < v.motions.size(); ++i)
        for (std::size_t k = 0; k < v.motions.size(); ++k)
            j[v.motions[i]][v.motions[k]] = v.counts[i][k];
    return j;
}

json to_json(const psychometric_functions& v)
{
    json people = json::object();
    for (std::size_t i = 0; i < v.codes.size(); ++i) {
        const fitted_function& m = v.people[i];
        json answers = json::array();
        for (const answer_block& b : m.blocks)
            answers.push_back({{"value", b.x}, {"n", b.n}, {"positive", b.k}});
        const auto parameter = [&m](double psychometric::*p) {
            return m.fit ? json(m.fit->parameters.*p) : json(nullptr);
        };
        people[v.codes[i]] = {{"alpha", parameter(&psychometric::threshold)},
                              {"beta", parameter(&psychometric::slope)},
                              {"lapse", parameter(&psychometric::lapse)},
                              {"guess", m.guess},
                              {"pse", or_null(m.pse)},
                              {"jnd", or_null(m.jnd)},
                              {"threshold", parameter(&psychometric::threshold)},
                              {"ci",
                               {{"pse", interval_json(m.pse ? m.bootstrap.threshold : std::nullopt)},
                                {"jnd", interval_json(m.jnd_ci)},
                                {"threshold", interval_json(m.bootstrap.threshold)}}},
                              {"deviance", m.fit ? json(m.fit->deviance) : json(nullptr)},
                              {"p_gof", or_null(m.bootstrap.p_gof)},
                              {"answers", std::move(answers)}};
    }
    json j{{"function", v.family.kind == sigmoid::normal ? "normal" : "logistic"},
           {"axis", v.on_db_axis ? "dB" : "linear"},
           {"participants", std::move(people)},
           {"mean", json::object()}};
    for (const measured_figure& f : v.figures) {
        j["mean"][f.name] = or_null(f.test.mean);
        j["tests"][f.name] = test_json(f.test);
    }
    return j;
}

json to_json(const sensitivities& v)
{
    json people = json::object();
    for (std::size_t i = 0; i < v.codes.size(); ++i)
        if (const auto& d = v.people[i])
            people[v.codes[i]] = {{"hits", d->hits},
                                  {"false_alarms", d->false_alarms},
                                  {"dprime", d->found.dprime},
                                  {"c", d->found.c}};
    json j{{"participants", std::move(people)}};
    j.update(test_json(v.figures.front().test));
    j["likelihood_ratio"] = nullptr;
    if (const auto& d = v.ratio)
        j["likelihood_ratio"] = {{"value", d->likelihood_ratio}, {"p", d->p}, {"studies", d->studies}};
    return j;
}

json to_json(const exponents& v)
{
    json people = json::object();
    for (std::size_t i = 0; i < v.codes.size(); ++i)
        people[v.codes[i]] = or_null(v.people[i].exponent);
    json j{{"participants", std::move(people)}};
    j.update(test_json(v.figures.front().test));
    return j;
}

json run_json(const run_analysis& r)
{
    json j{{"task", task_in(r.run).name()}, {"n", r.n}};
    for (const result& row : r.results) {
        json* at = &j;
        for (const std::string& key : row.at)
            at = &(*at)[key];
        *at = value_json(row.value);
    }
    j["trials"] = r.trials;
    j["early"] = r.early;
    j["response_time"] = times_json(r.times);
    j["left_out"] = left_out_json(r.missing);
    return j;
}

} // namespace

nlohmann::ordered_json value_json(const result_value& v)
{
    return std::visit([](const auto& one) { return to_json(one); }, v);
}

nlohmann::ordered_json times_json(const response_times& t)
{
    json j{{"median_s", or_null(t.median_s)}, {"by", json::object()}};
    for (const auto& [condition, median_s] : t.by)
        j["by"][condition] = or_null(median_s);
    return j;
}

nlohmann::ordered_json left_out_json(const std::vector<left_out>& all)
{
    json j = json::array();
    for (const left_out& l : all)
        j.push_back({{"participant", l.participant}, {"why", l.why}});
    return j;
}

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
