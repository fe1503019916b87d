// SPDX-License-Identifier: MIT
/// \file
/// The methods section of a paper about a study, as Markdown: its sections, each with its heading, the words
/// and equations (TeX between dollar signs) of stimuli with their sources, and sentences about facts that may
/// differ between participants.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/plan.hpp>

#include "files/json/json_value.hpp"
#include "study/analysis/analysis.hpp"
#include "study/report/facts.hpp"

namespace tactor::study {

/// Describes who took part.
std::string participants_section(const study_facts& f, const analysis& a);
/// Describes array, carrier, levels, thresholds, the sound device.
std::string apparatus_section(const study_facts& f);
/// Describes timing law, algorithms, phantom models, motions.
std::string stimuli_section(const study_facts& f);
/// Describes runs, trials, order, masking, breaks.
std::string procedure_section(const study_facts& f, const dataset& d);
/// Gives the results as tactor analyze computes them; each is marked where the study is simulated.
std::string results_section(const analysis& a);
/// Lists the papers that `named` names.
std::string references_section(std::string_view named);

/// Returns "SOA = 0.32 d + 0.0473".
std::string timing_law(const timing_profile& p);

/// Returns the options that are not the default, in words; "the defaults".
std::string method_options(const plan_options& o);

/// Describes an algorithm or a phantom model by its name in a plan; calls an unknown one the user's own.
std::string algorithm_text(std::string_view name);
std::string phantom_text(std::string_view name);

/// Returns "a sine of 250 Hz, amplitude-modulated at ..." for a plan (schema tactor-plan/1).
std::string describe_carrier(const json_value& plan);

/// Returns the shape of its bursts but for the ramps' length: "raised-cosine ramps".
std::string describe_envelope(const json_value& plan);

/// Returns the rise times of actuators and the remedy; empty if none takes time.
std::string describe_rise(const json_value& plan);

/// Writes the whole text. `a` analyses `d`, and `f` is from the same folder as `d`. Every number is from its
/// files.
std::string methods_text(const study_facts& f, const dataset& d, const analysis& a);

/// Checks that a name is one for a text in Markdown: it ends in .md. \throws error (bad_input).
void check_report_name(const std::filesystem::path& file);

/// Writes it whole, or nothing. \throws error: bad_input for the name, a folder that does not exist, a file
/// that was read as input or, without `force`, a file that is no report of tactor; runtime for what the
/// system refuses.
void write_report(const std::filesystem::path& file, const std::string& text, bool force);

/// Returns a name or text from a file on one line, with Markdown's own characters escaped.
std::string plain(std::string_view text);

/// Returns several, with commas between.
std::string plain_list(const std::vector<std::string>& names);

/// Returns a number with six digits, more than any device of this field has.
std::string digits(double v);

/// Returns "sub-01, sub-02".
std::string subjects(std::span<const std::string> codes);

/// Return a line of a table, and a table's head with the line under it.
std::string table_row(const std::vector<std::string>& cells);
std::string table_head(const std::vector<std::string>& cells);

/// Texts in the order in which they first came, each with the sessions that say it.
using shared_texts = std::vector<std::pair<std::string, std::vector<std::string>>>;
void add_text(shared_texts& all, std::string text, const std::string& who);

/// Returns the text of all sessions, or each text with the sessions that say it if they differ. An empty text
/// reads "not recorded".
std::string join_texts(const study_facts& f, const std::function<std::string(const session_facts&)>& say);

/// Returns the least and the largest value, or the only one; "not recorded" for none.
std::string range_text(const std::vector<double>& values);

inline constexpr const char* not_recorded = "not recorded";

} // namespace tactor::study
