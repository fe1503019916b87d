// SPDX-License-Identifier: MIT
/// \file
/// Questionnaires of a definition: [[run]] with task = "questionnaire", which has no trials.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactor::detail {
class toml_table;
}

namespace tactor::study {

/// Place of a questionnaire in a session.
enum class questionnaire_time {
    before,  ///< before the first run
    between, ///< after each run except the last
    after,   ///< after the last run
};

/// Kind of answer.
enum class item_kind { choice, number, text, scale };

/// [[run.item]]: a question and its possible answers.
struct questionnaire_item {
    std::string name; ///< column of the table: letters, digits and _
    std::string question;
    item_kind kind = item_kind::text;
    std::vector<std::string> labels = {}; ///< labels of all answers, or of the two ends; may be empty
    unsigned lowest = 1;                  ///< smallest answer; unused for a text
    unsigned greatest = 1;
    bool is_line = false; ///< true if a scale is a line without numbers

    friend bool operator==(const questionnaire_item&, const questionnaire_item&) = default;
};

struct questionnaire {
    std::string name; ///< NAME of phenotype/NAME.tsv: letters, digits and _
    questionnaire_time when = questionnaire_time::before;
    std::string title = {};
    std::string text = {};
    std::vector<questionnaire_item> items = {};

    friend bool operator==(const questionnaire&, const questionnaire&) = default;
};

/// Reads the key `scale`, a number of steps or "vas". Returns the greatest answer, or nothing if the key is
/// missing. Sets `visual` to true for "vas" and to false for a number. \throws error (bad_input) with line
/// and column.
std::optional<unsigned> read_scale(const detail::toml_table& t, bool& visual);

/// Reads a [[run]] with task = "questionnaire". `others`: the questionnaires that come before it in the
/// definition. \throws error (bad_input) with line and column.
questionnaire read_questionnaire(const detail::toml_table& run, const std::vector<questionnaire>& others);

/// Returns the path of a questionnaire's table of answers in a study's folder, phenotype/NAME.tsv. With the
/// extension ".json", returns the path of the table's description.
std::filesystem::path answers_path(const questionnaire& q, const char* extension = ".tsv");

/// Returns "before the first run", "after each run but the last" or "after the last run".
std::string_view describe_time(questionnaire_time t) noexcept;

/// Returns one label for each of two or more answers. If there are only two labels, they are for the first
/// and the last answer, and all other labels are empty. If `labels` is empty, all labels are empty.
std::vector<std::string> spread_labels(const std::vector<std::string>& labels, std::size_t answers);

/// Returns one label for each answer, from `lowest` up. A label is empty if only the number is shown. Returns
/// an empty list for items that ask for a number or a text.
std::vector<std::string> list_answer_labels(const questionnaire_item& item);

} // namespace tactor::study
