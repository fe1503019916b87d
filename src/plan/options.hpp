// SPDX-License-Identifier: MIT
/// \file
/// Checks of plan_options.
#pragma once

#include <tactor/plan.hpp>

namespace tactor::detail {

/// Solves Eq. (1) for the duration, with Eq. (11): a burst never outlasts its SOA. No check of bounds.
double law_duration_s(const timing_profile& p, double soa_s);

/// \throws error (bad_input) for options that the algorithm cannot use.
void check_options(const plan_options& o);

/// Returns the common options with the choices of a stroke.
plan_options apply_choices(plan_options common, const stroke_choices& c);

} // namespace tactor::detail
