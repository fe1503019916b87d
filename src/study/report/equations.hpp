// SPDX-License-Identifier: MIT
/// \file
/// How stimuli are computed, in equations with their sources; TeX between dollar signs.
#pragma once

#include <string>
#include <string_view>

#include <tactor/plan.hpp>

namespace tactor::study {

/// "SOA = 0.32 d + 0.0473"
std::string timing_law(const timing_profile& p);

/// What is set and not the default, in words; "the defaults".
std::string method_options(const plan_options& o);

/// Of an algorithm or a phantom model by its name in a plan. One that is not known is said to be the user's
/// own.
std::string algorithm_text(std::string_view name);
std::string phantom_text(std::string_view name);

} // namespace tactor::study
