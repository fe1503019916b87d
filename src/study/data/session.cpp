// SPDX-License-Identifier: MIT
#include "study/data/session.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>

#include "study/data/text_table.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::json;

json read_object(const std::filesystem::path& file)
{
    const std::string text = read_file(file);
    try {
        json j = json::parse(text);
        if (!j.is_object())
            throw error(error_kind::bad_input, file.string() + ":1", "it is no object", "it begins with {");
        return j;
    } catch (const json::parse_error& e) {
        const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(e.byte, text.size()));
        throw error(error_kind::bad_input,
                    fmt::format("{}:{}", file.string(), 1 + std::count(text.begin(), end, '\n')),
                    "it is no JSON", "it was changed, or not written to its end");
    }
}

const json& need(const std::filesystem::path& file, const json& j, const char* key, json::value_t type)
{
    const auto at = j.find(key);
    if (at == j.end() || at->type() != type)
        throw error(error_kind::bad_input, file.string(),
                    at == j.end() ? fmt::format("{} is missing", key)
                                  : fmt::format("{} is of another type", key),
                    "tactor-analyze(1) says what is read");
    return *at;
}

} // namespace

session_data read_session(const std::filesystem::path& file)
{
    const json j = read_object(file);
    session_data s;
    s.simulated = need(file, j, "simulated", json::value_t::boolean).get<bool>();
    const json& e = need(file, j, "experiment", json::value_t::object);
    s.text = need(file, e, "text", json::value_t::string).get<std::string>();
    s.experiment = read_outline(s.text, file.string() + ": experiment.text");
    return s;
}

void check_description(const std::filesystem::path& file, const run_outline& run)
{
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored)))
        return;
    const json j = read_object(file);
    const auto at = j.find("TaskName");
    if (at != j.end() && (!at->is_string() || file_name_of(at->get<std::string>()) != run.file_name))
        throw error(error_kind::bad_input, file.string(), fmt::format("its TaskName is not \"{}\"", run.name),
                    "the name of the run, or its letters and digits");
}

} // namespace tactor::study
