// SPDX-License-Identifier: MIT
// The tables of methods and of notifications.
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/player.hpp>

#include "core/bounds.hpp"
#include "core/kind_names.hpp"
#include "core/members.hpp"
#include "server/files.hpp"
#include "server/params.hpp"
#include "server/service.hpp"
#include "session/piece.hpp"

namespace tactor::server {
namespace {

using net::reply_json;
namespace of = detail::bounds_of;

reply_json number(const detail::bounds& b)
{
    return make_schema("number", b);
}

reply_json either(const reply_json& a, const reply_json& b)
{
    return {{"anyOf", {a, b}}};
}

reply_json list(const reply_json& elements, const detail::bounds& b)
{
    reply_json schema = make_schema("array", b);
    schema["items"] = elements;
    return schema;
}

// Returns the schema of a start.
reply_json make_start(const reply_json& stroke)
{
    constexpr double most_s = 9e9; // about three centuries
    return either(make_choice({"now", "armed"}),
                  make_object({{"delay_s", number({0.0, longest_wait_s})},
                               {"monotonic_s", number({0.0, most_s})},
                               {"unix_s", number({0.0, most_s})},
                               {"after", either(stroke, list(stroke, {1.0, 64.0}))}},
                              {}, {"delay_s", "monotonic_s", "unix_s", "after"}));
}

// Returns the parameters of a method that uses strokes with options.
reply_json make_stroke_object(reply_json members, const std::vector<std::string_view>& required = {})
{
    members["options"] = {{"$ref", "#/$defs/options"}}; // replace_options() checks them
    for (const std::string_view name : session::source_names())
        members[std::string(name)] =
            name == "points" ? reply_json{{"$ref", "#/$defs/points"}} : make_schema("string");
    return make_object(std::move(members), required, session::source_names());
}

} // namespace

const std::vector<service::method>& service::methods()
{
    static const std::vector<method> all = [] {
        constexpr double most_strokes = std::numeric_limits<std::uint32_t>::max();
        const reply_json stroke = make_schema("integer", {0.0, most_strokes});
        const reply_json start = make_start(make_schema("integer", {1.0, most_strokes}));
        const reply_json gain = number({player::least_level_db, 0.0});
        const reply_json place = number({-detail::max_mm, detail::max_mm}); // the stroke clamps or refuses it
        const reply_json text = make_schema("string");
        const reply_json flag = make_schema("boolean");
        reply_json yes = flag;
        yes["const"] = true;
        reply_json label = make_schema("string", {1.0, 40.0});
        label["pattern"] = R"(^[^\u0000-\u001f\u007f-\u009f]*$)"; // label_fault() checks it
        const reply_json event = make_choice({"strokes", "levels", "stream", "touches", "stops"});
        return std::vector<method>{
            {"hello", make_object({{"token", text}, {"name", label}}), &service::hello},
            {"play", make_stroke_object({{"start", start},
                                         {"gain_db", gain},
                                         {"repeat", either(yes, make_schema("integer", {1.0, 1e6}))},
                                         {"round_s", number(detail::from_0)},
                                         {"pause_s", number(detail::from_0)},
                                         {"held", flag}})},
            {"plan", make_stroke_object({{"start", start},
                                         {"view", make_choice({view_names.begin(), view_names.end()})},
                                         {"draft", make_schema("integer", of::seed)},
                                         {"bins", make_schema("integer", {1.0, 4000.0})},
                                         {"observer", make_choice(detail::kind_names<observer_kind>())}})},
            {"level", make_object({{"db", gain}, {"stroke", stroke}}, {"db"}), &service::level},
            {"cancel", make_object({{"stroke", stroke}, {"all", yes}}, {}, {"stroke", "all"}),
             &service::cancel},
            {"stop", reply_json::object(), &service::stop},
            {"fire", make_object(), &service::fire},
            {"begin",
             make_object({{"options", {{"$ref", "#/$defs/options"}}},
                          {"timeout_s", number(of::timeout_s)},
                          {"smooth_s", number(of::smooth_s)}}),
             &service::begin},
            {"to",
             make_object({{"stroke", stroke},
                          {"x_mm", place},
                          {"y_mm", place},
                          {"intensity", number(detail::from_0)}},
                         {"stroke", "x_mm", "y_mm"}),
             &service::to},
            {"end", make_object({{"stroke", stroke}}, {"stroke"}), &service::end},
            {"drive",
             make_object({{"tactor", make_schema("integer", {0.0, detail::max_channels - 1.0})},
                          {"intensity", number(of::part)},
                          {"duration_s", number(of::duration_s)},
                          {"start", start}},
                         {"tactor"}),
             &service::drive},
            {"status", make_object(), &service::status},
            {"subscribe",
             make_object({{"events", list(event, detail::any_number)}, {"levels_hz", number({0.01, 100.0})}},
                         {"events"}),
             &service::subscribe},
            {"options", make_object(), &service::list_options},
            {"qr", make_object({{"text", make_schema("string", {1.0, 400.0})}}, {"text"}), &service::make_qr},
            {"import", make_object({{"name", make_schema("string", {0.0, 255.0})},
                                    {"text", text},
                                    {"base64", text},
                                    {"stroke", text},
                                    {"fit", flag},
                                    {"intensity_max", number(of::intensity_max)},
                                    {"position", text}},
                                   {}, {"text", "base64", "stroke"})},
            {"export", make_stroke_object({{"fit", flag},
                                           {"as", make_choice(export_names())},
                                           {"name", make_schema("string", {1.0, 100.0})}},
                                          {"as"})}};
    }();
    return all;
}

const reply_json& service::notifications()
{
    static const reply_json all = [] {
        const auto told = [](const reply_json& members) {
            std::vector<std::string_view> names;
            for (const auto& [name, one] : members.items())
                names.push_back(name);
            return make_object(members, names);
        };
        const reply_json from_0 = make_schema("integer", {0.0, detail::any_number.high});
        const reply_json from_1 = make_schema("integer", {1.0, detail::any_number.high});
        const reply_json text = make_schema("string");
        const reply_json x = make_schema("number");
        const reply_json or_null = {{"type", {"number", "null"}}};
        return reply_json{
            {"stroke", told({{"stroke", from_1},
                             {"state", make_choice({"started", "finished", "cancelled", "interrupted"})},
                             {"reason", text},
                             {"frames", from_0},
                             {"started_s", or_null},
                             {"started_unix_s", or_null},
                             {"late_s", number(detail::from_0)},
                             {"held_points", from_0},
                             {"outside_points", from_0},
                             {"doubt", text}})},
            {"levels", told({{"t_s", x}, {"dbfs", list(or_null, detail::any_number)}})},
            {"touches", told({{"client", from_1},
                              {"stroke", from_1},
                              {"x_mm", x},
                              {"y_mm", x},
                              {"down", make_schema("boolean")}})},
            {"stops", told({{"client", from_0}, {"name", text}})},
            {"stream", told({{"state", make_choice({"running", "idle", "lost", "muted", "closing"})},
                             {"reason", text}})}};
    }();
    return all;
}

} // namespace tactor::server
