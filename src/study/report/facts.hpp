// SPDX-License-Identifier: MIT
/// \file
/// Parts of the report's facts, and the words that they share. Stimuli are in stimuli.cpp; runs, sessions
/// and questionnaires in procedure.cpp; all else in methods.cpp.
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

/// Returns "all" for a fact of everybody.
std::string name_subjects(const study_facts& f, const std::vector<std::string>& codes);

/// Returns a fact of a session in words: "none" where it is null.
std::string fact_text(const session_facts& s, const std::string& key);

std::string describe_carrier(const session_facts& s);

/// Tests whether any recorded stimulus has bursts.
bool has_bursts(const session_facts& s);

std::string law_text(const session_facts& s);

/// Lists the methods of the definition that were played, in the order in which they came.
nlohmann::ordered_json list_methods(const study_facts& f);

/// Lists the plans of each motion by each method, each once with the values that it is of. Those of one
/// option with more than a few values are one row of ranges.
nlohmann::ordered_json list_stimuli(const study_facts& f);

/// Lists what is noted of motions, and what the planner warned of.
std::set<std::string> list_notes(const study_facts& f);

std::string describe_pause(double s);

nlohmann::ordered_json describe_run(const study_facts& f, const run_outline& o, std::size_t run);

/// Returns what was so in a session, with the trials of each run that count, void ones, and those of them
/// with gaps in the sound.
nlohmann::ordered_json describe_session(const session_facts& s);

/// Returns the questionnaires of all definitions: when each is asked, its items, and how often it was
/// answered.
nlohmann::ordered_json list_questionnaires(const study_facts& f);

} // namespace tactor::study
