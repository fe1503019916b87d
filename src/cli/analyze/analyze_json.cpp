// SPDX-License-Identifier: MIT
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/analyze/analyze_output.hpp"
#include "files/json/json_value.hpp"

namespace tactor::cli {
namespace {

using files::or_null;
using json = nlohmann::ordered_json;

json ends(const std::optional<study::interval>& i)
{
    return i ? json::array({i->first, i->second}) : json(nullptr);
}

json test_json(const study::t_test& t)
{
    return {{"mean", or_null(t.mean)},
            {"se", or_null(t.se)},
            {"ci", ends(t.ci)},
            {"t", or_null(t.t)},
            {"df", or_null(t.df)},
            {"p", or_null(t.p)},
            {"p_signflip", or_null(t.p_signflip)},
            {"d", or_null(t.d)},
            {"d_ci", ends(t.d_ci)}};
}

json tests_json(const study::by_motion& b, const std::vector<std::string>& motions)
{
    json j{{"all", test_json(b.all)}, {"motion", json::object()}};
    for (std::size_t m = 0; m < motions.size(); ++m) {
        json one = test_json(b.motion[m]);
        one["p_holm"] = or_null(b.p_holm[m]);
        j["motion"][motions[m]] = std::move(one);
    }
    return j;
}

json mean_json(const study::t_test& t)
{
    return {{"mean", or_null(t.mean)}, {"se", or_null(t.se)}, {"ci", ends(t.ci)}};
}

json means_json(const study::by_motion& b, const std::vector<std::string>& motions)
{
    json j{{"all", mean_json(b.all)}, {"motion", json::object()}};
    for (std::size_t m = 0; m < motions.size(); ++m)
        j["motion"][motions[m]] = mean_json(b.motion[m]);
    return j;
}

// Null for a factor with one level, which has no effect.
json effect_json(const study::effect& e, std::size_t levels)
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
            {"mauchly_w", or_null(e.mauchly_w)},
            {"mauchly_p", or_null(e.mauchly_p)},
            {"eta2_partial", or_null(e.eta2_partial)},
            {"eta2_generalised", or_null(e.eta2_generalised)}};
}

json pairs_json(const std::vector<study::comparison>& pairs, const std::vector<std::string>& motions)
{
    json j = json::array();
    for (const study::comparison& c : pairs)
        j.push_back({{"a", motions[c.a]},
                     {"b", motions[c.b]},
                     {"difference", c.difference},
                     {"q", or_null(c.q)},
                     {"p", or_null(c.p)}});
    return j;
}

void add_choose(json& j, const study::run_analysis& r)
{
    const std::vector<std::string>& motions = r.run.motions;
    j["method"] = r.run.methods.back();
    j["preference"] = tests_json(r.cells[0], motions);
    j["first_interval"] = {{"mean", or_null(r.first_interval.mean)},
                           {"t", or_null(r.first_interval.t)},
                           {"p", or_null(r.first_interval.p)}};
    j["anova"] = {{"motion", effect_json(r.effects.second, motions.size())}};
    j["tukey"] = pairs_json(r.pairs[0], motions);
}

void add_rate(json& j, const study::run_analysis& r)
{
    const std::vector<std::string>& motions = r.run.motions;
    const std::vector<std::string>& methods = r.run.methods;
    j["means"] = json::object();
    for (std::size_t m = 0; m < methods.size(); ++m)
        j["means"][methods[m]] = means_json(r.cells[m], motions);
    const study::t_test& t = r.paired;
    j["paired"] = methods.size() < 2 ? json(nullptr) : json{{"difference", or_null(t.mean)},
                                                            {"ci", ends(t.ci)},
                                                            {"t", or_null(t.t)},
                                                            {"df", or_null(t.df)},
                                                            {"p", or_null(t.p)},
                                                            {"p_signflip", or_null(t.p_signflip)},
                                                            {"d_z", or_null(t.d)},
                                                            {"d_z_ci", ends(t.d_ci)}};
    j["anova"] = {
        {"method", effect_json(r.effects.first, methods.size())},
        {"motion", effect_json(r.effects.second, motions.size())},
        {"method:motion", effect_json(r.effects.interaction, std::min(methods.size(), motions.size()))}};
    j["tukey"] = json::object();
    for (std::size_t m = 0; m < methods.size(); ++m)
        j["tukey"][methods[m]] = pairs_json(r.pairs[m], motions);
}

void add_identify(json& j, const study::run_analysis& r)
{
    j["chance"] = study::chance(r.run);
    j["confusion"] = json::object();
    j["correct"] = json::object();
    for (std::size_t m = 0; m < r.run.methods.size(); ++m) {
        json matrix = json::object();
        for (std::size_t i = 0; i < r.run.motions.size(); ++i) {
            json row = json::object();
            for (std::size_t k = 0; k < r.run.motions.size(); ++k)
                row[r.run.motions[k]] = r.confusion[m][i][k];
            matrix[r.run.motions[i]] = std::move(row);
        }
        j["confusion"][r.run.methods[m]] = std::move(matrix);
        j["correct"][r.run.methods[m]] = tests_json(r.cells[m], r.run.motions);
    }
}

json run_json(const study::run_analysis& r)
{
    json j{{"task", to_string(r.run.task)}, {"n", r.n}};
    switch (r.run.task) {
    case study::task_kind::choose:
        add_choose(j, r);
        break;
    case study::task_kind::rate:
        add_rate(j, r);
        break;
    case study::task_kind::identify:
        add_identify(j, r);
        break;
    }
    j["trials"] = r.trials;
    j["early"] = r.early;
    j["left_out"] = json::array();
    for (const study::left_out& l : r.missing)
        j["left_out"].push_back({{"participant", l.participant}, {"why", l.why}});
    return j;
}

} // namespace

nlohmann::ordered_json make_analysis_json(const study::analysis& a)
{
    json j{{"schema", "tactor-analysis/1"}, {"experiment", a.experiment}, {"participants", a.participants},
           {"simulated", a.simulated},      {"runs", json::object()},     {"void", json::object()}};
    for (const study::run_analysis& r : a.runs) {
        j["runs"][r.run.name] = run_json(r);
        j["void"][r.run.name] = r.voids;
    }
    j["warnings"] = a.warnings;
    for (const std::string& w : a.no_figures)
        j["warnings"].push_back(w);
    return j;
}

} // namespace tactor::cli
