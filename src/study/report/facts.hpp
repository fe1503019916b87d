// SPDX-License-Identifier: MIT
/// \file
/// Functions that several files use for the facts of the report. stimuli.cpp defines the functions about
/// stimuli.
#pragma once

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

/// Returns a text such as "sub-1, sub-2".
inline std::string format_subjects(const std::vector<std::string>& codes)
{
    return "sub-" + join(codes, ", sub-");
}

std::string describe_carrier(const session_facts& s);

/// Returns true if any recorded stimulus has bursts.
bool has_bursts(const session_facts& s);

/// Lists the methods of the definition that were played, in the order of first appearance.
nlohmann::ordered_json list_methods(const study_facts& f);

/// Lists the plans of each motion and method. Each plan has one row, with the values of varied options.
/// If an option has many values, the plans of all its values share one row with ranges.
nlohmann::ordered_json list_stimuli(const study_facts& f);

/// Lists the notes on motions and the warnings of the planner. Texts about the same stimulus that differ only
/// in numbers become one entry.
std::vector<std::string> list_notes(const study_facts& f);

} // namespace tactor::study
