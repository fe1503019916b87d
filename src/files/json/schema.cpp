// SPDX-License-Identifier: MIT
#include "files/json/schema.hpp"

#include <cmath>

namespace tactor::files {

using json = nlohmann::ordered_json;

void json_schema::put(const char* name, json schema, bool required)
{
    properties_[name] = std::move(schema);
    if (required)
        (condition_.empty() ? required_ : conditional_).push_back(name);
}

void json_schema::require_exactly_one(const char* a, const char* b)
{
    one_of_ = {{{"required", {a}}}, {{"required", {b}}}};
}

json json_schema::result() &&
{
    json j = {{"type", "object"},
              {"additionalProperties", false},
              {"required", std::move(required_)},
              {"properties", std::move(properties_)}};
    if (!one_of_.is_null())
        j["oneOf"] = std::move(one_of_);
    if (!condition_.empty()) {
        j["if"] = {{"properties", {{condition_, {{"type", "null"}}}}}};
        j["then"] = {{"required", std::move(conditional_)}};
        j["else"] = {{"maxProperties", j["required"].size()}};
    }
    return j;
}

json json_schema::described(json schema, const detail::about& what)
{
    schema["description"] = what.text;
    return schema;
}

json json_schema::make_list(json items)
{
    return {{"type", "array"}, {"items", std::move(items)}};
}

json json_schema::make_map(json values)
{
    return {{"type", "object"}, {"additionalProperties", std::move(values)}};
}

json json_schema::number(const char* type, const detail::bounds& range)
{
    json j = {{"type", type}};
    const auto bound = [](double v) {
        return v == std::floor(v) ? json(static_cast<std::int64_t>(v)) : json(v);
    };
    if (std::isfinite(range.low))
        j[range.above_low ? "exclusiveMinimum" : "minimum"] = bound(range.low);
    if (std::isfinite(range.high))
        j["maximum"] = bound(range.high);
    return j;
}

json json_schema::allow_null(json schema)
{
    if (!schema.contains("type"))
        return {{"anyOf", {std::move(schema), {{"type", "null"}}}}};
    schema["type"] = {schema["type"], "null"};
    return schema;
}

} // namespace tactor::files
