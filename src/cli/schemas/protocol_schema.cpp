// SPDX-License-Identifier: MIT
#include "cli/schemas/protocol_schema.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/members.hpp"
#include "net/rpc.hpp"
#include "options/option.hpp"
#include "server/params.hpp"
#include "server/service.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;
using server::make_object;
using server::make_schema;
using server::service;

json refer_to(const std::string& name)
{
    return {{"$ref", "#/$defs/" + name}};
}

// Allows members that later versions may add, also in the objects within.
json open(json schema)
{
    if (schema.contains("additionalProperties"))
        schema["additionalProperties"] = true;
    if (const auto members = schema.find("properties"); members != schema.end())
        for (auto& [name, member] : members->items())
            member = open(member);
    if (const auto elements = schema.find("items"); elements != schema.end())
        *elements = open(*elements);
    return schema;
}

json describe(const options::option& o)
{
    using options::kind;
    const detail::bounds& b = o.range.empty() ? o.allowed : detail::any_number; // else other values set them
    switch (o.what) {
    case kind::number:
        return make_schema("number", b);
    case kind::whole:
        return make_schema("integer", b);
    case kind::choice:
        return server::make_choice(o.choices());
    case kind::flag:
        return make_schema("boolean");
    default: // a text, or also a number if numbers are allowed
        return {{"type", o.allowed.high > 0.0 ? json::array({"string", "number"}) : json("string")}};
    }
}

json describe_options()
{
    json all = json::object();
    for (const options::option& o : options::all())
        if ((o.where & options::by_client) != 0)
            all[std::string(o.name)] = describe(o);
    return make_object(std::move(all));
}

json describe_points()
{
    const json row = {
        {"type", "array"}, {"minItems", 3}, {"maxItems", 4}, {"items", {{"type", {"number", "null"}}}}};
    return {{"type", "array"}, {"minItems", 2}, {"items", row}};
}

json make_message(json members, std::vector<std::string_view> required)
{
    members["jsonrpc"] = {{"const", "2.0"}};
    required.emplace_back("jsonrpc");
    return make_object(std::move(members), required);
}

json describe_requests()
{
    json all = json::array();
    for (const service::method& m : service::methods()) {
        json params = m.params;
        const bool needed = params.contains("oneOf") || !params.value("required", json()).empty();
        if (!needed && !params.empty())
            params.update({{"type", {"object", "array", "null"}}, {"maxItems", 0}});
        std::vector<std::string_view> required{"method"};
        if (needed)
            required.emplace_back("params");
        all.push_back(make_message(
            {{"method", {{"const", m.name}}}, {"id", refer_to("id")}, {"params", params}}, required));
    }
    return {{"oneOf", all}};
}

json describe_notifications()
{
    json all = json::array();
    for (const auto& [name, params] : service::notifications().items())
        all.push_back(
            make_message({{"method", {{"const", name}}}, {"params", open(params)}}, {"method", "params"}));
    return {{"oneOf", all}};
}

// Returns the schema of an object that has a result of each method.
json describe_results()
{
    json all = json::object();
    for (const service::method& m : service::methods())
        all[m.name] = open(m.result);
    return make_object(std::move(all));
}

json describe_reply()
{
    const json text = make_schema("string");
    const json codes = {net::code_parse_error, net::code_invalid_request, net::code_no_method,
                        net::code_bad_params,  net::code_internal,        net::code_no_stream,
                        net::code_limit,       net::code_no_stroke,       net::code_no_token};
    const json data = open(make_object({{"kind", text}, {"what", text}, {"why", text}, {"hint", text}},
                                       {"kind", "what", "why", "hint"}));
    const json error = open(make_object({{"code", {{"enum", codes}}}, {"message", text}, {"data", data}},
                                        {"code", "message", "data"}));
    json reply =
        make_message({{"id", refer_to("id")}, {"result", make_schema("object")}, {"error", error}}, {"id"});
    reply["oneOf"] = {{{"required", {"result"}}}, {{"required", {"error"}}}};
    return reply;
}

} // namespace

json protocol_schema()
{
    const json one_way = {{"anyOf", {refer_to("request"), refer_to("reply")}}};
    const json batch = {
        {"type", "array"}, {"minItems", 1}, {"maxItems", net::most_requests}, {"items", one_way}};
    return {{"anyOf", {refer_to("request"), refer_to("reply"), refer_to("notification"), batch}},
            {"$defs",
             {{"id", {{"type", {"string", "number", "null"}}}},
              {"options", describe_options()},
              {"points", describe_points()},
              {"request", describe_requests()},
              {"reply", describe_reply()},
              {"results", describe_results()},
              {"notification", describe_notifications()}}}};
}

} // namespace tactor::cli
