// SPDX-License-Identifier: MIT
#include "study/analysis/result_json.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "study/results/result_members.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

using files::json_schema;
using json = nlohmann::ordered_json;

template <class Io>
void describe_value_member(Io& io, const char* name, const result_value& v)
{
    std::visit([&](const auto& one) { describe_row_member(io, name, one); }, v);
}

// Describes the members of a run that follow the rows.
template <class Io>
void describe_last_members(Io& io, const run_analysis& r)
{
    io("trials", r.trials, {"trials that count"});
    io("early", r.early, {"answers marked early"});
    io("dropped", r.dropped, {"trials left out by drop_rule"});
    io("track_rule", r.track_rule, {"keys of the definition that may end tracks early; empty: none"});
    io("tracks", r.tracks, {"tracks of these participants; empty without track_rule"});
    io("response_time", r.times, {"response times"});
    io("left_out", r.missing, {"participants who lack a cell"});
}

json run_json(const run_analysis& r)
{
    json j{{"task", find_run_task(r.run).name()}, {"n", r.n}};
    for (const result& row : r.results) {
        json* at = &j;
        for (const std::string& key : row.at)
            at = &(*at)[key];
        *at = value_json(row.value);
    }
    j.update(files::make_object([&r](auto& io) { describe_last_members(io, r); }));
    return j;
}

// Adds the schema of a row to the schema of an object, under the names in `at`.
void add_row_schema(json& object, std::span<const std::string> at, const json& value, bool required)
{
    json& needed = object["required"];
    if (required && std::ranges::count(needed, json(at[0])) == 0)
        needed.push_back(at[0]);
    json& member = object["properties"][at[0]];
    if (at.size() == 1) {
        member = value;
        return;
    }
    if (member.is_null())
        member = json_schema::make_map(at.size() == 2 ? value : json_schema::describe_object([](auto&) {}));
    if (at.size() > 2)
        add_row_schema(member["additionalProperties"], at.subspan(2), value, true);
}

// Returns the schema of a run with the task `kind` and these rows.
json run_schema(const task& kind, const std::vector<result_outline>& rows)
{
    json j = json_schema::describe_object([&kind](auto& io) {
        io.constant("task", kind.name());
        io("n", std::size_t{}, {"participants in the figures"});
    });
    for (const result_outline& row : rows) {
        json value =
            json_schema::describe_object([&row](auto& io) { describe_value_member(io, "value", row.value); });
        value = value["properties"]["value"];
        add_row_schema(j, row.at, row.or_null ? json_schema::allow_null(value) : value, !row.optional);
    }
    const json end = json_schema::describe_object([](auto& io) { describe_last_members(io, {}); });
    for (const json& name : end["required"])
        j["required"].push_back(name);
    j["properties"].update(end["properties"]);
    j["properties"]["groups"] = json_schema::make_map({{"$ref", "#/$defs/run"}});
    return j;
}

} // namespace

nlohmann::ordered_json value_json(const result_value& v)
{
    return files::make_object([&v](auto& io) { describe_value_member(io, "value", v); })["value"];
}

nlohmann::ordered_json make_analysis_json(const analysis& a)
{
    json j{{"schema", "tactor-analysis/1"}, {"experiment", a.experiment}, {"participants", a.participants},
           {"simulated", a.simulated},      {"drop_rule", a.drop_rule},   {"runs", json::object()},
           {"void", json::object()}};
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

nlohmann::ordered_json analysis_schema()
{
    json j = json_schema::describe_object([](auto& io) {
        io.constant("schema", "tactor-analysis/1");
        io("experiment", std::string(), {"name of the experiment"});
        io("participants", std::size_t{}, {"participants in the analysis", detail::above_0});
        io("simulated", bool{}, {"whether the answers are those of simulated observers"});
        io("drop_rule", std::string(), {"which trials are left out, in words; empty: none"});
        io("runs", by_name<bool>(), {"by name, in the order of the experiment"});
        io("void", by_name<std::size_t>(), {"by run: trials of all participants that do not count"});
        io("warnings", std::vector<std::string>(), {"texts, as on standard error"});
    });
    j["properties"]["runs"]["additionalProperties"] = {{"$ref", "#/$defs/run"}};
    json all = json::array();
    for (const task* one : list_tasks())
        for (const std::vector<result_outline>& rows : one->outline_results())
            all.push_back(run_schema(*one, rows));
    j["$defs"]["run"] = {{"oneOf", std::move(all)}};
    return j;
}

} // namespace tactor::study
