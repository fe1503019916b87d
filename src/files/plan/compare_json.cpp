// SPDX-License-Identifier: MIT

#include <nlohmann/json.hpp>

#include "files/plan/json_value.hpp"
#include "files/plan/plan_json.hpp"

namespace tactor::files {
namespace {

using detail::comparison;
using detail::comparison_row;
using detail::interval;
using detail::observer_choice;
using detail::prediction;
using detail::row_spread;
using detail::spread_choice;

using json = nlohmann::ordered_json;

json observer_json(const observer_choice& o)
{
    const bool taps = o.kind == observer_kind::low_speed;
    return {{"name", to_string(o.kind)},
            {"sigma_mm", taps ? json(o.low_speed.sigma_mm) : json(nullptr)},
            {"sigma_v_mm_s", taps ? json(o.low_speed.sigma_v_mm_s) : json(nullptr)},
            {"built_for", taps ? json("taps") : json(nullptr)}};
}

json interval_json(const std::optional<interval>& v)
{
    return v ? json{v->low, v->high} : json(nullptr);
}

json spread_json(const comparison_row& r)
{
    if (!r.spread)
        return nullptr;
    const row_spread& s = *r.spread;
    return {{"rms_error_mm", interval_json(s.rms_error_mm)},
            {"largest_error_mm", interval_json(s.largest_error_mm)},
            {"speed_cv", interval_json(s.speed_cv)},
            {"intensity_cv", interval_json(s.intensity_cv)},
            {"felt_length_mm", interval_json(s.felt_length_mm)},
            {"length_ratio", interval_json(s.length_ratio)}};
}

json people_json(const comparison& c)
{
    const spread_choice& s = c.spread;
    if (s.people == 0)
        return nullptr;
    const bool by_taps = c.observer.kind == observer_kind::low_speed;
    return {{"people", s.people},
            {"seed", s.seed},
            {"sigma_factor", by_taps ? json(s.sigma_factor) : json(nullptr)},
            {"threshold_db", s.threshold_db},
            {"place_mm", s.place_mm},
            {"parts", {0.05, 0.95}}};
}

// Returns true if the low-speed observer has a prediction.
bool has_taps(const prediction& r, observer_kind by)
{
    return by == observer_kind::low_speed && r.unpredicted.empty();
}

json compared_row_json(const comparison_row& r, observer_kind by)
{
    json j;
    j["algorithm"] = to_string(r.algorithm);
    j["phantom"] = to_string(r.phantom);
    j["refused"] = r.refused ? json(r.refused->what()) : json(nullptr);
    if (r.refused)
        return j;
    const plan& p = *r.plan;
    j["bursts"] = p.curve ? json(nullptr) : json(p.bursts.size());
    j["soa_s"] = or_null(p.soa_s);
    j["total_s"] = p.total_s;
    j.update(errors_json(r, by));
    j["taps"] = has_taps(r, by) ? json::array() : json(nullptr);
    for (const tap& t : r.taps)
        j["taps"].push_back(tap_json(t));
    j["spread"] = spread_json(r);
    j["warnings"] = p.warnings;
    return j;
}

json comparison_json(const comparison& c, const array& a)
{
    const trajectory& m = c.target.motion;
    json j;
    j["schema"] = "tactor-compare/1";
    j["note"] = detail::prediction_note(c.observer);
    j["observer"] = observer_json(c.observer);
    j["compensated_for"] =
        c.compensated ? observer_json({observer_kind::low_speed, c.observer.low_speed}) : json(nullptr);
    j["spread"] = people_json(c);
    if (c.faces != faces_kind::delaunay)
        j["faces"] = to_string(c.faces);
    j["stroke"] = {{"name", c.target.name}, {"duration_s", m.duration_s()}, {"length_mm", m.length_mm()}};
    if (c.target.note != note_kind::none)
        j["stroke"]["note"] = note_text(c.target.note);
    json tactors = json::array();
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        tactors.push_back(
            {{"tactor", i}, {"x_mm", t.position.x_mm}, {"y_mm", t.position.y_mm}, {"channel", t.channel}});
    }
    j["array"] = {{"name", a.name}, {"tactors", tactors}};
    j["results"] = json::array();
    for (const comparison_row& r : c.rows)
        j["results"].push_back(compared_row_json(r, c.observer.kind));
    return j;
}

} // namespace

json errors_json(const prediction& r, observer_kind by)
{
    const bool by_energy = by == observer_kind::centroid;
    const bool by_taps = has_taps(r, by);
    return {{"rms_error_mm", or_null(r.felt.rms_error_mm)},
            {"largest_error_mm", or_null(r.felt.largest_error_mm)},
            {"speed_cv", or_null(r.felt.speed_cv)},
            {"intensity_cv", or_null(r.felt.intensity_cv)},
            {"silent_share", by_energy ? json(r.felt.silent_share) : json(nullptr)},
            {"shared_share", by_energy ? json(r.felt.shared_share) : json(nullptr)},
            {"unpredicted", or_null(r.unpredicted)},
            {"felt_length_mm", by_taps ? json(r.tapped.felt_length_mm) : json(nullptr)},
            {"target_length_mm", by_taps ? json(r.tapped.target_length_mm) : json(nullptr)},
            {"length_ratio", or_null(r.tapped.length_ratio)}};
}

std::string comparisons_text(const std::vector<comparison>& all, const array& a)
{
    json whole;
    if (all.size() == 1) {
        whole = comparison_json(all[0], a);
    } else {
        whole = {{"schema", "tactor-compares/1"}, {"comparisons", json::array()}};
        for (const comparison& c : all)
            whole["comparisons"].push_back(comparison_json(c, a));
    }
    return whole.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

} // namespace tactor::files
