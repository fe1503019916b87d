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

// Returns the schema of an object that has all these members.
reply_json make_whole(const reply_json& members)
{
    std::vector<std::string_view> names;
    for (const auto& [name, one] : members.items())
        names.push_back(name);
    return make_object(members, names);
}

reply_json make_list(const reply_json& members)
{
    return list(make_whole(members), detail::any_number);
}

reply_json text()
{
    return make_schema("string");
}

reply_json list_texts()
{
    return list(text(), detail::any_number);
}

reply_json count_from(double least)
{
    return make_schema("integer", {least, detail::any_number.high});
}

reply_json make_nullable(std::string_view type)
{
    return {{"type", {type, "null"}}};
}

reply_json describe_hello()
{
    const reply_json names = list_texts();
    const reply_json whole = count_from(0.0);
    const reply_json flag = make_schema("boolean");
    const reply_json seconds = make_schema("number");
    return make_whole({{"protocol", make_choice({"tactor/1"})},
                       {"version", text()},
                       {"array", make_schema("object")},
                       {"stream", make_whole({{"rate", whole},
                                              {"channels", whole},
                                              {"format", make_nullable("string")},
                                              {"period_frames", whole},
                                              {"latency_s", make_nullable("number")},
                                              {"pcm", text()}})},
                       {"presets", names},
                       {"shapes", names},
                       {"formats", make_list({{"name", text()},
                                              {"title", text()},
                                              {"extensions", names},
                                              {"media_type", text()},
                                              {"written", flag},
                                              {"only_points", flag}})},
                       {"clock", make_whole({{"monotonic_s", seconds}, {"unix_s", seconds}})},
                       {"max_level_dbfs", make_schema("number")},
                       {"client", count_from(1.0)}});
}

reply_json make_stream_state()
{
    return make_choice({session::stream_state_names.begin(), session::stream_state_names.end()});
}

reply_json describe_status()
{
    const reply_json whole = count_from(0.0);
    return make_whole(
        {{"version", text()},
         {"stream", make_whole({{"state", make_stream_state()},
                                {"reason", text()},
                                {"xruns", whole},
                                {"uptime_s", number(detail::from_0)},
                                {"realtime", make_schema("boolean")}})},
         {"amplifier", make_choice({"on", "off", "none"})},
         {"clients", whole},
         {"who", make_list({{"client", count_from(1.0)}, {"name", text()}, {"from", text()}})},
         {"strokes", make_list({{"stroke", count_from(1.0)},
                                {"state", make_choice({"waiting", "armed", "started", "ended"})},
                                {"client", whole}})},
         {"max_level_dbfs", make_schema("number")},
         {"limits", make_schema("object")}});
}

reply_json describe_options()
{
    return make_list({{"name", text()},
                      {"key", make_nullable("string")},
                      {"group", text()},
                      {"kind", make_choice({options::kind_names.begin(), options::kind_names.end()})},
                      {"unit", text()},
                      {"least", make_nullable("number")},
                      {"most", make_nullable("number")},
                      {"choices", list_texts()},
                      {"default", reply_json::object()},
                      {"help", text()},
                      {"live", make_schema("boolean")}});
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
        const reply_json flag = make_schema("boolean");
        reply_json yes = flag;
        yes["const"] = true;
        reply_json label = make_schema("string", {1.0, 40.0});
        label["pattern"] = R"(^[^\u0000-\u001f\u007f-\u009f]*$)"; // label_fault() checks it
        const reply_json none = make_schema("object");
        const reply_json begun = make_whole({{"stroke", count_from(1.0)}});
        const reply_json rows = list(make_schema("object"), detail::any_number);
        const reply_json event = make_choice({"strokes", "levels", "stream", "touches", "stops"});
        return std::vector<method>{
            {"hello", make_object({{"token", text()}, {"name", label}}), describe_hello(), &service::hello},
            {"play",
             make_stroke_object({{"start", start},
                                 {"gain_db", gain},
                                 {"repeat", either(yes, make_schema("integer", {1.0, 1e6}))},
                                 {"round_s", number(detail::from_0)},
                                 {"pause_s", number(detail::from_0)},
                                 {"held", flag}}),
             make_whole({{"stroke", count_from(1.0)},
                         {"strokes", list(count_from(1.0), detail::any_number)},
                         {"total_s", number(detail::from_0)},
                         {"warnings", list_texts()},
                         {"weakened_db", make_schema("number")}})},
            {"plan",
             make_stroke_object({{"start", start},
                                 {"view", make_choice({view_names.begin(), view_names.end()})},
                                 {"draft", make_schema("integer", of::seed)},
                                 {"bins", make_schema("integer", {1.0, 4000.0})},
                                 {"observer", make_choice(detail::kind_names<observer_kind>())}}),
             make_schema("object")}, // plan_json() and the views describe it
            {"level", make_object({{"db", gain}, {"stroke", stroke}}, {"db"}), none, &service::level},
            {"cancel", make_object({{"stroke", stroke}, {"all", yes}}, {}, {"stroke", "all"}), none,
             &service::cancel},
            {"stop", reply_json::object(), none, &service::stop},
            {"fire", make_object(), make_whole({{"count", count_from(0.0)}}), &service::fire},
            {"begin",
             make_object({{"options", {{"$ref", "#/$defs/options"}}},
                          {"timeout_s", number(of::timeout_s)},
                          {"smooth_s", number(of::smooth_s)}}),
             begun, &service::begin},
            {"to",
             make_object({{"stroke", stroke},
                          {"x_mm", place},
                          {"y_mm", place},
                          {"intensity", number(detail::from_0)}},
                         {"stroke", "x_mm", "y_mm"}),
             none, &service::to},
            {"end", make_object({{"stroke", stroke}}, {"stroke"}), none, &service::end},
            {"drive",
             make_object({{"tactor", make_schema("integer", {0.0, detail::max_channels - 1.0})},
                          {"intensity", number(of::part)},
                          {"duration_s", number(of::duration_s)},
                          {"start", start}},
                         {"tactor"}),
             begun, &service::drive},
            {"status", make_object(), describe_status(), &service::status},
            {"subscribe",
             make_object({{"events", list(event, detail::any_number)}, {"levels_hz", number({0.01, 100.0})}},
                         {"events"}),
             none, &service::subscribe},
            {"options", make_object(), make_whole({{"options", describe_options()}}), &service::list_options},
            {"qr", make_object({{"text", make_schema("string", {1.0, 400.0})}}, {"text"}),
             make_whole({{"size", count_from(1.0)}, {"path", text()}}), &service::make_qr},
            {"import",
             make_object({{"name", make_schema("string", {0.0, 255.0})},
                          {"text", text()},
                          {"base64", text()},
                          {"stroke", text()},
                          {"fit", flag},
                          {"intensity_max", number(of::intensity_max)},
                          {"position", text()}},
                         {}, {"text", "base64", "stroke"}),
             make_whole({{"toml", text()},
                         {"strokes", rows},
                         {"points", list(make_schema("array"), detail::any_number)},
                         {"warnings", list_texts()}})},
            {"export",
             make_stroke_object({{"fit", flag},
                                 {"as", make_choice(export_names())},
                                 {"name", make_schema("string", {1.0, 100.0})}},
                                {"as"}),
             make_whole(
                 {{"name", text()}, {"mime", text()}, {"base64", text()}, {"warnings", list_texts()}})}};
    }();
    return all;
}

const reply_json& service::notifications()
{
    static const reply_json all = [] {
        const reply_json from_0 = count_from(0.0);
        const reply_json from_1 = count_from(1.0);
        const reply_json x = make_schema("number");
        return reply_json{
            {"stroke",
             make_whole({{"stroke", from_1},
                         {"state", make_choice({"started", "finished", "cancelled", "interrupted"})},
                         {"reason", text()},
                         {"frames", from_0},
                         {"started_s", make_nullable("number")},
                         {"started_unix_s", make_nullable("number")},
                         {"late_s", number(detail::from_0)},
                         {"held_points", from_0},
                         {"outside_points", from_0},
                         {"doubt", text()}})},
            {"levels", make_whole({{"t_s", x}, {"dbfs", list(make_nullable("number"), detail::any_number)}})},
            {"touches", make_whole({{"client", from_1},
                                    {"stroke", from_1},
                                    {"x_mm", x},
                                    {"y_mm", x},
                                    {"down", make_schema("boolean")}})},
            {"stops", make_whole({{"client", from_0}, {"name", text()}})},
            {"stream", make_whole({{"state", make_stream_state()}, {"reason", text()}})}};
    }();
    return all;
}

} // namespace tactor::server
