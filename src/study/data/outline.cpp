// SPDX-License-Identifier: MIT
#include "study/data/outline.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/json/json_value.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::study {

std::string_view to_string(task_kind t) noexcept
{
    return t == task_kind::choose ? "choose" : t == task_kind::rate ? "rate" : "identify";
}

std::string make_file_name(std::string_view run)
{
    std::string name;
    for (const char c : run)
        if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))
            name += c;
    return name;
}

std::filesystem::path source_path(std::string_view code)
{
    return std::filesystem::path("sourcedata") / fmt::format("sub-{}", code);
}

std::filesystem::path table_path(std::string_view code, const run_outline& run)
{
    return std::filesystem::path(fmt::format("sub-{}", code)) / "beh" /
           fmt::format("sub-{}_task-{}_beh.tsv", code, run.file_name);
}

std::filesystem::path description_path(const run_outline& run)
{
    return fmt::format("task-{}_beh.json", run.file_name);
}

session_data read_session(const std::filesystem::path& file)
{
    const std::string name = file.string();
    const nlohmann::ordered_json j = files::read_object(read_file(file), name);
    const files::json_value all(j, name, "tactor-analyze(1) says what is read");
    session_data s;
    s.simulated = all["simulated"].need_truth();
    s.text = all["experiment"]["text"].need_text();
    s.experiment = read_outline(s.text, name + ": experiment.text");
    return s;
}

} // namespace tactor::study
