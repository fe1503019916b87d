// SPDX-License-Identifier: MIT
/// \file
/// Functions for predictions that several files use.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// Returns the array with the tactors at the places where the person feels them.
/// \throws error (bad_input) as predict_percept() does.
array felt_array(const array& a, const person& who);

/// Returns factors on amplitudes by tactor; empty if all are 1.
/// \throws error (bad_input) as predict_percept() does.
std::vector<double> person_gains(const array& a, const person& who);

/// Throws error (bad_input) for a plan that drives a tactor that the array does not have.
[[noreturn]] void refuse_tactor(const array& a, unsigned tactor);

/// Returns the number of samples of a movement: at 0, 1, 2 ... ms.
/// \throws error (bad_input) if the movement is longer than longest_percept_s.
std::size_t count_percept_samples(double duration_s);

class target_places;

/// Returns exactly the result of summarise() for predict_percept(), but stores no samples. `targets`: places
/// of the stroke, which all plans of the stroke can share. Passes the samples to `each`, without speeds and
/// target intensities. \throws error (bad_input) as predict_percept().
percept_summary predict_summary(const array& a, const target_places& targets, double duration_s,
                                const plan& p, const person& who = {},
                                const std::function<void(const percept_sample&)>& each = {});

/// Plans a stroke, and moves the bursts for `observer`. If `observer` is null, plans as make_plan() does, and
/// sets only the plan in the result. \throws error (bad_input) as make_compensated_plan().
compensated_plan plan_for_observer(const array& a, const layout& l, const stroke& s, const plan_options& o,
                                   const low_speed_observer* observer);

} // namespace tactor::detail
