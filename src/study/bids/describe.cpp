// SPDX-License-Identifier: MIT
#include "study/bids/study_folder.hpp"

#include <ctime>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/version.hpp>

#include "core/split.hpp"
#include "study/data/columns.hpp"

namespace tactor::study {
namespace {

using ordered = nlohmann::ordered_json;

constexpr const char* simulated_note = "SIMULATED: nobody was asked. The answers come from a model; they "
                                       "test the software and say nothing about people.";

// Texts by which a data set says what wrote it.
constexpr std::string_view held_by = "tactor experiment";
constexpr std::string_view simulated_by = "tactor experiment --simulate";

ordered column_json(std::string_view description, std::string_view units = {})
{
    ordered j{{"Description", description}};
    if (!units.empty())
        j["Units"] = units;
    return j;
}

std::string response_meaning(const run_definition& r)
{
    if (r.outline.task == task_kind::choose)
        return "Which of the two stimuli was chosen, 1 or 2";
    if (r.outline.task == task_kind::rate)
        return fmt::format("The rating, 1 to {}", r.outline.scale);
    return "The motion that was named";
}

constexpr std::int64_t second_ns = 1000000000;
constexpr std::int64_t microsecond_ns = 1000;
constexpr std::size_t seconds_length = 19; // 2026-11-21T14:03:00
constexpr std::size_t fraction_length = 7;

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
    return json_text(j);
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
    return json_text(j);
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
    j["early"]["Levels"] = {{"true", fmt::format("sooner than {} s", r.min_response_s)}, {"false", "later"}};
    j["void"]["Levels"] = {{"true", "does not count"}, {"false", "counts"}};
    return json_text(j);
}

std::string acq_time_text(std::int64_t utc_ns)
{
    const std::time_t t = utc_ns / second_ns;
    std::tm utc{};
    ::gmtime_r(&t, &utc);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                       utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, utc_ns % second_ns / microsecond_ns);
}

std::optional<std::int64_t> acq_time_ns(const std::string& text)
{
    std::tm utc{};
    const std::size_t length = text.size() - (text.ends_with('Z') ? 1 : 0);
    if (length != seconds_length + fraction_length ||
        ::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S.", &utc) != text.c_str() + seconds_length + 1)
        return {};
    const auto microseconds = detail::number_in<std::int64_t>(
        std::string_view(text).substr(seconds_length + 1, fraction_length - 1));
    if (!microseconds || *microseconds < 0)
        return {};
    return ::timegm(&utc) * second_ns + *microseconds * microsecond_ns;
}

std::int64_t utc_now_ns() noexcept
{
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return now.tv_sec * second_ns + now.tv_nsec;
}

} // namespace tactor::study
