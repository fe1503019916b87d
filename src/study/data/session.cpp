// SPDX-License-Identifier: MIT
#include "study/data/session.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>

#include "files/plan/json_value.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::study {

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

void check_description(const std::filesystem::path& file, const run_outline& run)
{
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored)))
        return;
    const nlohmann::ordered_json j = files::read_object(read_file(file), file.string());
    const auto at = j.find("TaskName");
    if (at != j.end() && (!at->is_string() || file_name_of(at->get<std::string>()) != run.file_name))
        throw error(error_kind::bad_input, file.string(), fmt::format("its TaskName is not \"{}\"", run.name),
                    "the name of the run, or its letters and digits");
}

} // namespace tactor::study
