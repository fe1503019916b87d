// SPDX-License-Identifier: MIT
#include "study/session/calibration_facts.hpp"

#include <fmt/format.h>

#include "files/plan/json_values.hpp"
#include "session/threshold_carrier.hpp"

namespace tactor::study {
namespace {

using files::or_null;
using json = nlohmann::ordered_json;

json tactor_facts(const calibrated_tactor& t)
{
    return {{"tactor", t.tactor},
            {"threshold_dbfs", or_null(t.threshold_dbfs)},
            {"sd_db", or_null(t.sd_db)},
            {"trials", t.trials}};
}

} // namespace

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
        tactors.push_back(tactor_facts(t));
    return {{"participant", c.participant}, {"method", c.method},         {"rule", or_null(c.rule)},
            {"carrier_hz", c.carrier_hz},   {"interval_s", c.interval_s}, {"feedback", or_null(c.feedback)},
            {"masker", or_null(c.masker)},  {"date", or_null(c.date)},    {"seed", or_null(c.seed)},
            {"simulated", c.simulated},     {"tactors", tactors},         {"warnings", p.calibration_doubts}};
}

} // namespace tactor::study
