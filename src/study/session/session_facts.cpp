// SPDX-License-Identifier: MIT
#include "study/session/prepared.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <tactor/version.hpp>

#include "core/sha256.hpp"
#include "files/json/json_value.hpp"
#include "files/plan/plan_members.hpp"
#include "session/environment.hpp"

namespace tactor::study {

namespace {

using files::or_null;
using json = nlohmann::ordered_json;

json array_facts(const array& a)
{
    json tactors = json::array();
    for (const tactor_spec& t : a.tactors) {
        tactors.push_back({{"x_mm", t.position.x_mm},
                           {"y_mm", t.position.y_mm},
                           {"channel", t.channel},
                           {"polarity", t.polarity},
                           {"gain_db", t.gain_db},
                           {"max_dbfs", t.max_dbfs},
                           {"threshold_dbfs", files::make_document(files::find_thresholds(t))},
                           {"actuator", std::string(to_string(t.actuator))}});
        if (t.displacement_um_at_0dbfs) // else absent: sessions of older versions go on
            tactors.back()["displacement_um_at_0dbfs"] = *t.displacement_um_at_0dbfs;
    }
    return {{"name", a.name}, {"tactors", tactors}};
}

// Returns the pauses before the trials of each run, in the order of the trials.
json rest_facts(const prepared_experiment& p)
{
    json all = json::object();
    for (const run_sequence& r : p.runs) {
        json& rests = all[p.definition.runs[r.run].outline.name] = json::array();
        for (const planned_trial& t : r.trials)
            rests.push_back(t.rest_s);
    }
    return all;
}

} // namespace

json level_facts(const experiment_definition& d)
{
    return {{"sl_db", d.level_dbfs ? json(nullptr) : json(d.sl_db)}, {"dbfs", or_null(d.level_dbfs)}};
}

json masking_facts(const masking_definition& m)
{
    if (m.noise == noise_kind::none)
        return nullptr;
    return {{"noise", std::string(to_string(m.noise))},
            {"level_dbfs", m.level_dbfs},
            {"fade_s", m.fade_s},
            {"while", m.through_run ? "run" : "stimulus"}};
}

json stimulus_facts(const prepared_experiment& p)
{
    json all = json::array();
    for (const run_definition& r : p.definition.runs)
        for (const std::size_t motion : r.motions)
            for (const std::size_t method : r.methods) {
                const json one{{"sha256", p.stimuli.at(motion, method).hash},
                               {"motion", p.definition.motions[motion].name},
                               {"method", p.definition.methods[method].name}};
                if (std::find(all.begin(), all.end(), one) == all.end())
                    all.push_back(one);
            }
    return all;
}

json describe_session(const prepared_experiment& p, const std::optional<simulation>& simulate,
                      const std::string& masker)
{
    json thresholds = json::array();
    for (const tactor_spec& t : p.where.tactors.tactors)
        thresholds.push_back(files::make_document(files::find_thresholds(t)));
    json order = json::array();
    for (const run_sequence& r : p.runs)
        order.push_back(p.definition.runs[r.run].outline.name);
    const experiment_definition& d = p.definition;
    json j{{"schema", "tactor-session/1"}, {"participant", p.participant}};
    j["simulated"] = simulate.has_value();
    j["simulation"] = simulate ? json(to_text(*simulate)) : json(nullptr);
    j["seed"] = p.seed;
    j["order"] = order;
    j["level"] = level_facts(d);
    // These are absent where they say nothing: sessions of older versions go on.
    if (p.hand)
        j["hand"] = std::string(to_string(*p.hand));
    if (d.rest.is_random())
        j["rests_s"] = rest_facts(p);
    j["array"] = array_facts(p.where.tactors);
    j["thresholds_dbfs"] = thresholds;
    j["thresholds_assumed"] = p.assumed;
    j["calibration"] = calibration_facts(p);
    j["rate"] = p.render.rate;
    j["channels"] = p.render.channels;
    j["masking"] = masking_facts(d.masking);
    j["masker"] = simulate || masker.empty() ? json(nullptr) : json(masker);
    j["stimuli"] = stimulus_facts(p);
    j["experiment"] = {{"name", d.name}, {"sha256", detail::sha256_text(d.text)}, {"text", d.text}};
    j["versions"] = {{"tactor", std::string(version())}, {"build", std::string(build_facts())}};
    j["device"] = simulate ? json(nullptr) : json(p.pcm);
    j["sound_server"] = nullptr;
    j["masker_sound_server"] = nullptr;
    j["streams"] = json::array();
    j["date"] = nullptr;
    return j;
}

std::vector<std::string> calibration_doubts(const std::string& participant, const session::environment& e,
                                            const stimulus_set& stimuli)
{
    if (!e.config.calibration)
        return {};
    const calibration_origin& c = *e.config.calibration;
    std::vector<std::string> doubts;
    if (c.simulated)
        doubts.emplace_back("the thresholds were simulated: nobody was asked");
    if (!participant.empty() && c.participant != participant)
        doubts.push_back(
            fmt::format("the thresholds are of participant {}, not {}", c.participant, participant));
    std::vector<const plan*> plans;
    for (const stimulus* s : stimuli.all())
        plans.push_back(&s->plan);
    if (std::string other = session::other_carrier(e, plans); !other.empty())
        doubts.push_back(std::move(other));
    return doubts;
}

json calibration_facts(const prepared_experiment& p)
{
    if (!p.where.config.calibration)
        return nullptr;
    const calibration_origin& c = *p.where.config.calibration;
    json tactors = json::array();
    for (const calibrated_tactor& t : c.tactors)
        tactors.push_back({{"tactor", t.tactor},
                           {"threshold_dbfs", or_null(t.threshold_dbfs)},
                           {"sd_db", or_null(t.sd_db)},
                           {"trials", t.trials}});
    return {{"participant", c.participant}, {"method", c.method},         {"rule", or_null(c.rule)},
            {"carrier_hz", c.carrier_hz},   {"interval_s", c.interval_s}, {"feedback", or_null(c.feedback)},
            {"masker", or_null(c.masker)},  {"date", or_null(c.date)},    {"seed", or_null(c.seed)},
            {"simulated", c.simulated},     {"tactors", tactors},         {"warnings", p.calibration_doubts}};
}

} // namespace tactor::study
