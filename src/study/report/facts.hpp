// SPDX-License-Identifier: MIT
/// \file
/// Parts of the report's facts that several files use. stimuli.cpp defines the parts about stimuli.
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

/// Returns "sub-1, sub-2".
inline std::string list_subjects(const std::vector<std::string>& codes)
{
    return "sub-" + join(codes, ", sub-");
}

std::string describe_carrier(const session_facts& s);

/// Returns true if any recorded stimulus has bursts.
bool has_bursts(const session_facts& s);

/// Lists the methods of the definition that were played, in the order in which they first came.
nlohmann::ordered_json list_methods(const study_facts& f);

/// Lists the plans of each motion by each method, each plan once with its values. If an option has more than
/// a few values, its plans share one row of ranges.
nlohmann::ordered_json list_stimuli(const study_facts& f);

/// Lists the notes on motions and the warnings of the planner. Those of a stimulus that differ only in
/// numbers, such as those of several values, are one.
std::vector<std::string> list_notes(const study_facts& f);

} // namespace tactor::study
