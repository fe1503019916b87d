// SPDX-License-Identifier: MIT
// Writes the schemas of what the tool prints as JSON into a folder: write-schemas FOLDER
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/check/check.hpp"
#include "cli/play/play.hpp"
#include "cli/settings.hpp"
#include "files/json/schema.hpp"
#include "files/plan/plan_json.hpp"
#include "session/device.hpp"

namespace {

using json = nlohmann::ordered_json;

// Turns the marks in descriptions into options of the tool.
void spell(json& schema)
{
    for (auto& [key, value] : schema.items())
        if (key == "description" && value.is_string())
            value = tactor::cli::spelled(value.get<std::string>());
        else if (value.is_structured())
            spell(value);
}

json titled(std::string_view what, const json& object)
{
    json j = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", fmt::format("tactor {}; see also tactor-json(5)", what)}};
    j.update(object);
    spell(j);
    return j;
}

// Returns the schema of a document that only has a list of objects.
json list_schema(const char* name, const char* key, const json& one)
{
    return {{"type", "object"},
            {"additionalProperties", false},
            {"required", {"schema", key}},
            {"properties",
             {{"schema", {{"const", name}}}, {key, {{"type", "array"}, {"minItems", 2}, {"items", one}}}}}};
}

} // namespace

int main(int argc, char** argv)
{
    if (argc != 2)
        return 2;
    bool complete = true;
    const auto write = [&](std::string_view name, const json& schema) {
        const auto file = std::filesystem::path(argv[1]) / fmt::format("tactor-{}-1.schema.json", name);
        std::ofstream out(file);
        out << schema.dump(2) << std::endl;
        complete = complete && out.good();
    };
    const json plan = titled("plan --format json, one stroke", tactor::files::plan_schema());
    const json compare = titled("compare --format json, one stroke", tactor::files::compare_schema());
    const auto without_dialect = [](json j) {
        j.erase("$schema");
        return j;
    };
    write("plan", plan);
    write("plans", titled("plan --format json, several strokes",
                          list_schema("tactor-plans/1", "plans", without_dialect(plan))));
    write("compare", compare);
    write("compares", titled("compare --format json, several strokes",
                             list_schema("tactor-compares/1", "comparisons", without_dialect(compare))));
    write("play", titled("play --format json", tactor::cli::play_schema()));
    write("devices", titled("devices --format json", tactor::session::devices_schema()));
    write("check", titled("check --format json", tactor::cli::check_schema()));
    return complete ? 0 : 1;
}
