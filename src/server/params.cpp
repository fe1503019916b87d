// SPDX-License-Identifier: MIT
#include "server/params.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/suggest.hpp"
#include "core/words.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;
using names = std::vector<std::string_view>;

// A JSON type, the end of the names of its limits, and texts about values of other types.
struct json_type {
    std::string_view name;
    const char* limits;
    bool (json::*fits)() const noexcept;
    const char* why;
    const char* hint;
};

constexpr json_type types[] = {
    {"number", "imum", &json::is_number, "it is not a number", ""},
    {"integer", "imum", &json::is_number, "it is not a number", ""},
    {"string", "Length", &json::is_string, "it is not a text", "give a text in quotes"},
    {"array", "Items", &json::is_array, "it is not a list", "give a list"},
    {"object", "", &json::is_object, "it is not an object", "give an object with named members"},
    {"boolean", "", &json::is_boolean, "it is neither true nor false", "give true or false"},
};

const json_type& find_type(std::string_view name)
{
    return *std::find_if(std::begin(types), std::end(types),
                         [name](const json_type& t) { return t.name == name; });
}

const json_type& type_in(const reply_json& schema)
{
    return find_type(schema["type"].get_ref<const std::string&>());
}

detail::bounds find_bounds(const reply_json& schema)
{
    const std::string limits = type_in(schema).limits;
    return {schema.value("min" + limits, detail::any_number.low),
            schema.value("max" + limits, detail::any_number.high)};
}

std::string range_hint(const detail::bounds& b)
{
    return std::isfinite(b.high) ? fmt::format("use {} to {}", plain_number(b.low), plain_number(b.high))
                                 : fmt::format("use {} or more", plain_number(b.low));
}

// Returns the texts in a list of a schema.
names find_names(const reply_json& schema, const char* key)
{
    names all;
    if (const auto at = schema.find(key); at != schema.end())
        for (const reply_json& one : *at)
            all.emplace_back(one.get_ref<const std::string&>());
    return all;
}

// Throws the fault for a value that is missing or has another type.
[[noreturn]] void refuse(const reply_json& schema, const std::string& place, const char* why)
{
    const json_type& type = type_in(schema);
    refuse_param(place.empty() ? "params" : place, why,
                 schema.contains("enum") ? detail::choice_hint("", find_names(schema, "enum"))
                 : std::string_view(type.limits) == "imum" ? range_hint(find_bounds(schema))
                                                           : type.hint);
}

std::string join(const std::string& place, std::string_view name)
{
    return fmt::format("{}{}{}", place, place.empty() ? "" : ".", name);
}

void check_size(const reply_json& schema, std::size_t n, const char* unit, const std::string& place)
{
    if (const detail::bounds b = find_bounds(schema); !b.holds(static_cast<double>(n)))
        refuse_param(place, "it has " + counted(n, unit), range_hint(b));
}

void check_text(const reply_json& schema, const std::string& text, const std::string& place)
{
    const names known = find_names(schema, "enum");
    if (!known.empty() && std::find(known.begin(), known.end(), text) == known.end())
        refuse_param(place, fmt::format("\"{}\" is unknown", text), detail::choice_hint(text, known));
    const std::string why = schema.contains("pattern") ? label_fault(text) : "";
    if (!why.empty())
        refuse_param(place, "it " + why, label_hint);
    check_size(schema, text.size(), "byte", place);
}

// Checks that exactly one of the members in "oneOf" is present.
void check_sources(const reply_json& schema, const json& v, const std::string& place)
{
    names all;
    if (const auto at = schema.find("oneOf"); at != schema.end())
        for (const reply_json& one : *at)
            all.push_back(find_names(one, "required").front());
    std::string_view found;
    for (const std::string_view name : all) {
        if (!v.contains(name))
            continue;
        if (!found.empty())
            refuse_param(join(place, name), fmt::format("it cannot be combined with \"{}\"", found),
                         "give one of them");
        found = name;
    }
    if (found.empty() && !all.empty())
        refuse_param(join(place, all.front()), "it is missing",
                     fmt::format("give one of {}", fmt::join(all, ", ")));
}

void check_object(const reply_json& schema, const json& v, const std::string& place)
{
    const reply_json& members = schema["properties"];
    names known;
    for (const auto& [name, one] : members.items())
        known.push_back(name);
    for (const auto& [name, value] : v.items())
        if (!members.contains(name))
            refuse_param(name.empty() ? "params" : join(place, name),
                         name.empty() ? "one parameter has no name" : "it is unknown",
                         known.empty() ? "the method has no parameters" : detail::choice_hint(name, known));
    check_sources(schema, v, place);
    for (const std::string_view name : find_names(schema, "required"))
        if (!v.contains(name))
            refuse(members[std::string(name)], join(place, name), "it is missing");
    for (const auto& [name, value] : v.items())
        check_param(members[name], value, join(place, name));
}

} // namespace

reply_json make_schema(std::string_view type, const detail::bounds& b)
{
    const auto bound = [](double v) {
        return v == std::floor(v) ? reply_json(static_cast<std::int64_t>(v)) : reply_json(v);
    };
    const std::string limits = find_type(type).limits;
    reply_json schema = {{"type", type}};
    if (std::isfinite(b.low))
        schema["min" + limits] = bound(b.low);
    if (std::isfinite(b.high))
        schema["max" + limits] = bound(b.high);
    return schema;
}

reply_json make_choice(const names& all)
{
    return {{"type", "string"}, {"enum", all}};
}

reply_json make_object(reply_json members, const names& required, const names& sources)
{
    reply_json schema = {{"type", "object"},
                         {"additionalProperties", false},
                         {"required", required},
                         {"properties", std::move(members)}};
    for (const std::string_view name : sources)
        schema["oneOf"].push_back({{"required", names{name}}});
    return schema;
}

void check_range(const std::string& place, double v, const detail::bounds& b)
{
    if (!std::isfinite(v) || !b.holds(v))
        refuse_param(place, fmt::format("{} is out of range", v), range_hint(b));
}

void check_param(const reply_json& schema, const json& v, const std::string& place)
{
    if (const auto any = schema.find("anyOf"); any != schema.end()) {
        const auto fits = [&v](const reply_json& one) { return (v.*type_in(one).fits)(); };
        const auto found = std::find_if(any->begin(), any->end(), fits);
        return check_param(found == any->end() ? any->front() : *found, v, place);
    }
    if (!schema.contains("type"))
        return;
    if (!(v.*type_in(schema).fits)())
        refuse(schema, place, type_in(schema).why);
    if (v.is_number()) {
        const auto n = v.get<double>();
        check_range(place, n, find_bounds(schema));
        if (schema["type"] == "integer" && n != std::floor(n))
            refuse_param(place, fmt::format("{} is not a whole number", n));
    } else if (v.is_string()) {
        check_text(schema, v.get_ref<const std::string&>(), place);
    } else if (v.is_array()) {
        check_size(schema, v.size(), "element", place);
        for (const json& one : v)
            check_param(schema["items"], one, place);
    } else if (v.is_object()) {
        check_object(schema, v, place);
    } else if (schema.contains("const") && v == json(false)) {
        refuse_param(place, "it is not true", "give true");
    }
}

} // namespace tactor::server
