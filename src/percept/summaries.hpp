// SPDX-License-Identifier: MIT
/// \file
/// Summaries of several plans of a stroke in one pass, for any length.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// Returns summarise() of predict_percept() for each plan, equal to the last bit. Stores no samples, and
/// looks the target up once for all plans. Passes the samples of each plan to `each`, without their speeds.
/// \throws error (bad_input) as predict_percept().
std::vector<percept_summary> predict_summaries(const array& a, const stroke& s,
                                               std::span<const plan* const> plans,
                                               const std::function<void(const percept_sample&)>& each = {});

} // namespace tactor::detail
