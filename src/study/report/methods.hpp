// SPDX-License-Identifier: MIT
/// \file
/// The methods section of a paper about a study, as Markdown: methods.md, filled in with facts.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <tactor/plan.hpp>

#include "study/report/facts.hpp"

namespace tactor::study {

/// Returns the whole text. `f` is from the same folder as `d`; `analysis` is an object of tactor-analysis/1
/// about it.
std::string methods_text(const study_facts& f, const dataset& d, const nlohmann::ordered_json& analysis);

/// Checks that a name is one for a text in Markdown: it ends in .md. \throws error (bad_input).
void check_report_name(const std::filesystem::path& file);

/// Writes it whole, or nothing. \throws error: bad_input for the name, a folder that does not exist, a file
/// that was read as input or, without `force`, a file that is no report of tactor; runtime for what the
/// system refuses.
void write_report(const std::filesystem::path& file, const std::string& text, bool force);

/// Returns all facts by the names that methods.md has for them.
nlohmann::ordered_json collect_facts(const study_facts& f, const dataset& d,
                                     const nlohmann::ordered_json& analysis);

/// Returns methods.md, a template of Mustache with [[ and ]].
std::string_view methods_template() noexcept;

/// Returns a name or text from a file on one line, with Markdown's own characters escaped.
std::string escape_markdown(std::string_view text);

/// Returns the text of all sessions, or each text with the sessions that have it if they differ. An empty
/// text reads "not recorded".
std::string join_texts(const study_facts& f, const std::function<std::string(const session_facts&)>& text);

/// Returns the least and the largest value, or the only one; "not recorded" for none.
std::string range_text(const std::vector<double>& values);

/// Returns the settings of a method by the names of their options: "algorithm park2016, soa 0.07".
std::string method_options(const plan_options& o);

} // namespace tactor::study
