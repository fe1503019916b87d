// SPDX-License-Identifier: MIT
/// \file
/// Parts of predictions that several files use.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// Returns the array with its tactors at the places where they are felt.
/// \throws error (bad_input) as predict_percept() does.
array felt_array(const array& a, const person& who);

/// Returns factors on amplitudes by tactor; empty if all are 1.
/// \throws error (bad_input) as predict_percept() does.
std::vector<double> person_gains(const array& a, const person& who);

/// Refuses a plan that drives a tactor which the array does not have. \throws error (bad_input).
[[noreturn]] void refuse_tactor(const array& a, unsigned tactor);

/// Returns summarise() of predict_percept() for each plan, equal to the last bit. Stores no samples, and
/// looks the target up once for all plans. Passes the samples of each plan to `each`, without their speeds.
/// \throws error (bad_input) as predict_percept().
std::vector<percept_summary> predict_summaries(const array& a, const stroke& s,
                                               std::span<const plan* const> plans,
                                               const std::function<void(const percept_sample&)>& each = {});

} // namespace tactor::detail
