// SPDX-License-Identifier: MIT
/// \file
/// What a paper's methods section must say of a study, as Markdown.
#pragma once

#include <filesystem>
#include <string>

#include "study/analysis/analysis.hpp"
#include "study/report/facts.hpp"

namespace tactor::study {

/// `a` is of `d`, and `f` of the folder that `d` was read from. Every number is from its files.
std::string methods_text(const study_facts& f, const dataset& d, const analysis& a);

/// Whether a name is one for a text in Markdown: it ends in .md. \throws error (bad_input).
void check_report_name(const std::filesystem::path& file);

/// Writes it whole, or nothing. \throws error: bad_input for the name, a folder that does not exist, a file
/// that was read as input or, without `force`, one that is no report of tactor; runtime for what the system
/// refuses.
void write_report(const std::filesystem::path& file, const std::string& text, bool force);

} // namespace tactor::study
