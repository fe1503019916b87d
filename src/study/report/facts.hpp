// SPDX-License-Identifier: MIT
/// \file
/// Facts of the report, in parts, and the words that the parts share. Stimuli are in stimuli.cpp; runs,
/// sessions and questionnaires in procedure.cpp; everything else in methods.cpp.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/report/report.hpp"

namespace tactor::study {

inline constexpr const char* not_recorded = "not recorded";

template <class Texts>
std::string join(const Texts& texts, std::string_view between = ", ")
{
    return fmt::format("{}", fmt::join(texts, between));
}

/// Returns a list of sessions in words; "all" if these are all.
std::string name_subjects(const study_facts& f, const std::vector<std::string>& codes);

/// Returns a fact of a session in words: "none" where it is null.
std::string fact_text(const session_facts& s, const std::string& key);

std::string describe_carrier(const session_facts& s);

/// Tests whether any recorded stimulus has bursts.
bool has_bursts(const session_facts& s);

std::string law_text(const session_facts& s);

/// Lists the methods of the definition that were played, in the order in which they came.
nlohmann::ordered_json list_methods(const study_facts& f);

/// Lists the plans of each motion by each method, each plan once with its values. If an option has more than
/// a few values, its plans share one row of ranges.
nlohmann::ordered_json list_stimuli(const study_facts& f);

/// Lists the notes on motions and the warnings of the planner.
std::set<std::string> list_notes(const study_facts& f);

std::string describe_pause(double s);

nlohmann::ordered_json describe_run(const study_facts& f, const run_outline& o, std::size_t run);

/// Describes a session, with the number of trials of each run that count, of void trials, and of void trials
/// with gaps in the sound.
nlohmann::ordered_json describe_session(const session_facts& s);

/// Returns the questionnaires of all definitions: when each is asked, its items, and how often it was
/// answered.
nlohmann::ordered_json list_questionnaires(const study_facts& f);

} // namespace tactor::study
