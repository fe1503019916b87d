// SPDX-License-Identifier: MIT
// Writes the schemas of the tool's JSON output and of the protocol into a folder: write-schemas FOLDER
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/check/check.hpp"
#include "cli/experiment/experiment_options.hpp"
#include "cli/experiment/power.hpp"
#include "cli/play/play.hpp"
#include "cli/schemas/protocol_schema.hpp"
#include "cli/settings.hpp"
#include "files/json/schema.hpp"
#include "files/plan/plan_json.hpp"
#include "session/device.hpp"
#include "study/analysis/result_json.hpp"
#include "study/session/session_record.hpp"

namespace {

using json = nlohmann::ordered_json;

// Replaces the marks in descriptions by options of the tool.
void spell(json& schema)
{
    for (auto& [key, value] : schema.items())
        if (key == "description" && value.is_string())
            value = tactor::cli::spell_marks(value.get<std::string>());
        else if (value.is_structured())
            spell(value);
}

json add_schema_title(std::string_view what, const json& object, std::string_view page = "tactor-json(5)")
{
    json j = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", fmt::format("tactor {}; see also {}", what, page)}};
    j.update(object);
    spell(j);
    return j;
}

// Moves object schemas that occur several times to $defs. Each gets the name of the first member that uses
// it.
class object_sharer {
public:
    json share(json whole)
    {
        count(whole);
        replace(whole, "");
        json all = whole["$defs"];
        for (auto& [text, def] : found_)
            all[def.name] = std::move(def.schema);
        whole["$defs"] = std::move(all);
        return whole;
    }

private:
    struct definition {
        std::string name;
        json schema = {};
    };

    void count(const json& j)
    {
        if (j.is_object() && j.contains("properties"))
            ++uses_[j.dump()];
        if (j.is_structured())
            for (const json& inner : j)
                count(inner);
    }
    // Replaces a schema if it occurs several times. `name` is the member that has the schema.
    void replace(json& j, const std::string& name)
    {
        const std::string text = j.is_object() && j.contains("properties") ? j.dump() : "";
        if (text.empty() || uses_[text] < 2)
            return replace_inner(j, name);
        const auto [at, is_new] = found_.try_emplace(text, definition{find_unused_name(name)});
        if (is_new) {
            json own = j;
            replace_inner(own, name);
            at->second.schema = std::move(own);
        }
        j = {{"$ref", "#/$defs/" + at->second.name}};
    }
    void replace_inner(json& j, const std::string& name)
    {
        if (!j.is_structured())
            return;
        for (auto& [key, inner] : j.items()) {
            if (key != "properties") {
                replace(inner, name);
                continue;
            }
            for (auto& [member, its] : inner.items())
                replace(its, member);
        }
    }
    std::string find_unused_name(const std::string& name) const
    {
        const auto taken = [this](const std::string& one) {
            return std::ranges::any_of(found_, [&](const auto& f) { return f.second.name == one; });
        };
        std::string one = name;
        for (unsigned n = 2; taken(one); ++n)
            one = fmt::format("{}-{}", name, n);
        return one;
    }

    std::map<std::string, unsigned> uses_ = {};
    std::map<std::string, definition> found_ = {};
};

// Returns the schema of a document whose only content is a list of objects.
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
    const json plan = add_schema_title("plan --format json, one stroke", tactor::files::plan_schema());
    const json compare =
        add_schema_title("compare --format json, one stroke", tactor::files::comparison_schema());
    const auto without_dialect = [](json j) {
        j.erase("$schema");
        return j;
    };
    write("plan", plan);
    write("plans", add_schema_title("plan --format json, several strokes",
                                    list_schema("tactor-plans/1", "plans", without_dialect(plan))));
    write("compare", compare);
    write("compares",
          add_schema_title("compare --format json, several strokes",
                           list_schema("tactor-compares/1", "comparisons", without_dialect(compare))));
    write("play", add_schema_title("play --format json", tactor::cli::play_schema()));
    write("devices", add_schema_title("devices --format json", tactor::session::devices_schema()));
    write("experiment",
          add_schema_title("experiment --dry-run --format json", tactor::cli::dry_run_schema()));
    write("session", add_schema_title("session.json of a study", tactor::study::session_schema(),
                                      "tactor-experiment(1)"));
    write("power", add_schema_title("experiment --power --format json", tactor::cli::power_schema()));
    write("analysis",
          object_sharer().share(add_schema_title("analyze --format json", tactor::study::analysis_schema())));
    write("protocol",
          object_sharer().share(add_schema_title("serve, one message to or from a client",
                                                 tactor::cli::protocol_schema(), "tactor-protocol(7)")));
    write("check", add_schema_title("check --format json", tactor::cli::check_schema()));
    return complete ? 0 : 1;
}
