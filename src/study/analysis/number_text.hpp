// SPDX-License-Identifier: MIT
/// \file
/// Figures as papers print them. What is not there is a dash.
#pragma once

#include <optional>
#include <string>

#include "study/data/outline.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {

std::string value_text(std::optional<double> v, int decimals = 2);

/// "<.001" or "0.012".
std::string p_text(std::optional<double> p);

/// "p < 0.001" or "p = 0.012".
std::string p_clause(std::optional<double> p);

/// "1.20 ... 3.40"
std::string interval_text(const std::optional<interval>& i);

/// Limits of a mean of per cents, and of a run's values: per cents or ratings.
inline constexpr interval per_cents{0.0, 100.0};
interval possible_values(const run_outline& run);

/// The same, cut to what is possible: an interval from t knows no bounds.
std::string interval_text(const std::optional<interval>& i, const interval& possible);

/// "t(11) = 6.84, p < 0.001"; of a test that is there.
std::string t_text(const t_test& t);

/// F with its degrees of freedom, p and both eta squared, and what sphericity makes of it; of an effect that
/// has an F.
std::string effect_text(const effect& e);

} // namespace tactor::study
