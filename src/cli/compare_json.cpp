// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/compare_rows.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

template <class T>
json or_null(const std::optional<T>& v)
{
    return v ? json(*v) : json(nullptr);
}

json row_json(const comparison_row& r)
{
    json j;
    j["algorithm"] = to_string(r.method);
    j["phantom"] = to_string(r.phantom);
    j["refused"] = r.refused ? json(r.refused->what()) : json(nullptr);
    if (r.refused)
        return j;
    const plan& p = *r.schedule;
    j["bursts"] = p.at ? json(nullptr) : json(p.bursts.size());
    j["soa_s"] = or_null(p.soa_s);
    j["total_s"] = p.total_s;
    j["rms_error_mm"] = or_null(r.felt.rms_error_mm);
    j["largest_error_mm"] = or_null(r.felt.largest_error_mm);
    j["speed_cv"] = or_null(r.felt.speed_cv);
    j["intensity_cv"] = or_null(r.felt.intensity_cv);
    j["silent_share"] = r.felt.silent_share;
    j["shared_share"] = r.felt.shared_share;
    j["warnings"] = p.warnings;
    return j;
}

json comparison_json(const comparison& c, const array& a)
{
    const trajectory& m = c.target.motion;
    json j;
    j["schema"] = "tactor-compare/1";
    j["note"] = prediction_note;
    j["stroke"] = {{"name", c.target.name}, {"duration_s", m.duration_s()}, {"length_mm", m.length_mm()}};
    if (!c.target.note.empty())
        j["stroke"]["note"] = c.target.note;
    json tactors = json::array();
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        tactors.push_back(
            {{"tactor", i}, {"x_mm", t.position.x_mm}, {"y_mm", t.position.y_mm}, {"channel", t.channel}});
    }
    j["array"] = {{"name", a.name}, {"tactors", tactors}};
    j["results"] = json::array();
    for (const comparison_row& r : c.rows)
        j["results"].push_back(row_json(r));
    return j;
}

} // namespace

void print_json(std::FILE* out, const std::vector<comparison>& all, const array& a)
{
    if (all.size() == 1) {
        fmt::print(out, "{}\n",
                   comparison_json(all[0], a).dump(2, ' ', false, json::error_handler_t::replace));
        return;
    }
    json list = json::array();
    for (const comparison& c : all)
        list.push_back(comparison_json(c, a));
    fmt::print(out, "{}\n",
               json{{"schema", "tactor-compares/1"}, {"comparisons", list}}.dump(
                   2, ' ', false, json::error_handler_t::replace));
}

} // namespace tactor::cli
