// SPDX-License-Identifier: MIT
/// \file
/// Markdown from what files say, and sentences about what may differ between participants.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study/report/facts.hpp"

namespace tactor::study {

/// A name or text from a file: on one line, what Markdown takes for its own escaped.
std::string plain(std::string_view text);

/// Several, with commas between.
std::string plain_list(const std::vector<std::string>& names);

/// A number with six digits, more than any device of this field has.
std::string digits(double v);

/// "sub-01, sub-02"
std::string subjects(std::span<const std::string> codes);

/// A line of a table, and the line under a table's head.
std::string table_row(const std::vector<std::string>& cells);
std::string table_head(const std::vector<std::string>& cells);

/// Texts in the order in which they were first said, each with those who said it.
using sayings = std::vector<std::pair<std::string, std::vector<std::string>>>;
void add_saying(sayings& all, std::string text, const std::string& who);

/// What each session says: once where all say the same, else each with those who do. A session that says
/// nothing (an empty text) is told as "not recorded".
std::string told(const study_facts& f, const std::function<std::string(const session_facts&)>& say);

/// The least and the largest, or the one that all are; "not recorded" for none.
std::string range_text(const std::vector<double>& values);

inline constexpr const char* not_recorded = "not recorded";

} // namespace tactor::study
