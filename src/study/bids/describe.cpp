// SPDX-License-Identifier: MIT
#include "study/bids/study_folder.hpp"

#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/version.hpp>

#include "study/data/columns.hpp"

namespace tactor::study {
namespace {

using ordered = nlohmann::ordered_json;

constexpr const char* simulated_note = "SIMULATED: nobody was asked. The answers come from a model; they "
                                       "test the software and say nothing about people.";

// How a data set says what wrote it.
constexpr std::string_view held_by = "tactor experiment";
constexpr std::string_view simulated_by = "tactor experiment --simulate";

std::string description_text(const ordered& j)
{
    return j.dump(2, ' ', false, ordered::error_handler_t::replace) + "\n";
}

ordered column_json(std::string_view description, std::string_view units = {})
{
    ordered j{{"Description", description}};
    if (!units.empty())
        j["Units"] = units;
    return j;
}

std::string response_meaning(const run_definition& r)
{
    switch (r.outline.task) {
    case task_kind::choose:
        return "Which of the two stimuli was chosen, 1 or 2";
    case task_kind::rate:
        return fmt::format("The rating, 1 to {}", r.outline.scale);
    case task_kind::identify:
        break;
    }
    return "The motion that was named";
}

} // namespace

std::string dataset_text(const experiment_definition& d, bool simulated)
{
    ordered j{{"Name", d.title + (simulated ? " (simulated)" : "")},
              {"BIDSVersion", "1.8.0"},
              {"DatasetType", "raw"}};
    j["Authors"] = d.authors;
    j["GeneratedBy"] = {{{"Name", "tactor"},
                         {"Version", std::string(version())},
                         {"Description", simulated ? fmt::format("{}. {}", simulated_by, simulated_note)
                                                   : std::string(held_by)}}};
    return description_text(j);
}

std::optional<bool> says_simulated(const std::string& dataset_description)
{
    const ordered j = ordered::parse(dataset_description, nullptr, false);
    if (!j.is_object() || !j.contains("GeneratedBy") || !j["GeneratedBy"].is_array())
        return {};
    for (const ordered& by : j["GeneratedBy"]) {
        const std::string text = by.is_object() && by.contains("Description") && by["Description"].is_string()
                                     ? by["Description"].get<std::string>()
                                     : std::string();
        if (text.starts_with(simulated_by))
            return true;
        if (text.starts_with(held_by))
            return false;
    }
    return {};
}

std::string readme_text(const experiment_definition& d, bool simulated)
{
    return fmt::format(
        "{}\n\n{}This folder was written by tactor experiment (definition: {}). Vibrations moved over the "
        "skin, and after\n"
        "each trial a question was answered; each run is a task of its own, and sub-CODE/beh has a line for "
        "each\n"
        "trial. What the columns mean is in task-NAME_beh.json. The definition, the array, the levels and "
        "each\n"
        "stimulus, named by the SHA-256 of its plan, are in sourcedata. Trials whose column void is true "
        "were\n"
        "played or answered under conditions that were not as planned; they do not count, and come again.\n"
        "tactor analyze prints the statistics.\n",
        d.title, simulated ? std::string(simulated_note) + "\n\n" : std::string(), d.name);
}

std::string participants_text(bool simulated)
{
    ordered j;
    j["participant_id"] =
        column_json(simulated ? simulated_note : "A code, which says nothing about who it is");
    j["age"] = column_json("Age", "years");
    j["sex"] = column_json("Sex, as the participant says");
    j["sex"]["Levels"] = {{"F", "female"}, {"M", "male"}, {"O", "other"}};
    j["handedness"] = column_json("Hand that the participant prefers");
    j["handedness"]["Levels"] = {{"R", "right"}, {"L", "left"}, {"A", "both"}};
    return description_text(j);
}

std::string task_text(const run_definition& r, bool simulated)
{
    ordered j{{"TaskName", r.outline.name}};
    j["TaskDescription"] = fmt::format(
        "{}{}", simulated ? std::string(simulated_note) + " " : "",
        r.outline.task == task_kind::choose ? "Two stimuli, one after the other, of which one is chosen"
        : r.outline.task == task_kind::rate ? "One stimulus, which is rated"
                                            : "One stimulus, whose motion is named");
    j["Instructions"] = r.question;
    if (!r.labels.empty())
        j["Labels"] = r.labels;
    for (const trial_column& c : trial_columns)
        j[std::string(c.name)] = column_json(c.meaning.empty() ? response_meaning(r) : c.meaning, c.unit);
    j["void"]["Levels"] = {{"true", "does not count"}, {"false", "counts"}};
    return description_text(j);
}

} // namespace tactor::study
