// SPDX-License-Identifier: MIT
/// \file
/// What a paper's methods section must say of a study, as Markdown: its sections, each with its heading, and
/// the words and equations (TeX between dollar signs) of stimuli with their sources.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/plan.hpp>

#include "files/plan/json_value.hpp"
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
/// Describes void trials, versions, hashes.
std::string data_section(const study_facts& f, const dataset& d);
/// Gives the results as tactor analyze computes them; each is marked where the study is simulated.
std::string results_section(const analysis& a);
/// Lists the papers that `named` names.
std::string references_section(std::string_view named);

/// Returns "SOA = 0.32 d + 0.0473".
std::string timing_law(const timing_profile& p);

/// Returns the options that are not the default, in words; "the defaults".
std::string method_options(const plan_options& o);

/// Describes an algorithm or a phantom model by its name in a plan. One that is not known is called the
/// user's own.
std::string algorithm_text(std::string_view name);
std::string phantom_text(std::string_view name);

/// Returns "a sine of 250 Hz, amplitude-modulated at ..." for a plan (schema tactor-plan/1).
std::string carrier_of(const json_value& plan);

/// Returns the shape of its bursts but for the ramps' length: "raised-cosine ramps".
std::string envelope_of(const json_value& plan);

/// Says how long actuators take to move and what is done about it; empty where none takes time.
std::string rise_of(const json_value& plan);

/// Writes the whole text. `a` is of `d`, and `f` of the folder that `d` was read from. Every number is from
/// its files.
std::string methods_text(const study_facts& f, const dataset& d, const analysis& a);

/// Checks that a name is one for a text in Markdown: it ends in .md. \throws error (bad_input).
void check_report_name(const std::filesystem::path& file);

/// Writes it whole, or nothing. \throws error: bad_input for the name, a folder that does not exist, a file
/// that was read as input or, without `force`, one that is no report of tactor; runtime for what the system
/// refuses.
void write_report(const std::filesystem::path& file, const std::string& text, bool force);

/// Returns whether and where the target of a run was shown before the first stimulus.
std::string animation_text(const session_facts& s, std::size_t run);

/// Returns the masking noise that was played, with its device.
std::string masking_text(const session_facts& s);

/// Returns what the participant saw: a page or a terminal.
std::string display_text(const session_facts& s);

/// Returns when the participant agreed to the consent text.
std::string consent_text(const session_facts& s);

/// Returns which tactors were confirmed as felt before the runs, and when.
std::string walk_text(const session_facts& s);

/// Returns the days on which the session was held, UTC, in order and each once.
std::vector<std::string> session_days(const session_facts& s);

} // namespace tactor::study
