// SPDX-License-Identifier: MIT
/// \file
/// Parts of predictions that several files use.
#pragma once

#include <cstddef>
#include <functional>
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

/// Returns the number of samples of a movement: at 0, 1, 2 ... ms.
/// \throws error (bad_input) if it is longer than longest_percept_s.
std::size_t count_percept_samples(double duration_s);

class target_places;

/// Returns summarise() of predict_percept(), equal to the last bit. Stores no samples. Plans of one stroke
/// share `targets`, its places. Passes the samples to `each`, without speeds and target intensities.
/// \throws error (bad_input) as predict_percept().
percept_summary predict_summary(const array& a, const target_places& targets, double duration_s,
                                const plan& p, const person& who = {},
                                const std::function<void(const percept_sample&)>& each = {});

/// Plans a stroke. `observer`: moves its bursts for this observer; null: plans as make_plan() does, without
/// the other results. \throws error (bad_input) as make_compensated_plan().
compensated_plan plan_for(const array& a, const layout& l, const stroke& s, const plan_options& o,
                          const low_speed_observer* observer);

} // namespace tactor::detail
