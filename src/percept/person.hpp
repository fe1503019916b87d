// SPDX-License-Identifier: MIT
/// \file
/// Differences of a person from the person for whom a plan was made.
#pragma once

#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// Returns the array with its tactors at the places where they are felt.
/// \throws error (bad_input) as predict_percept() does.
array felt_array(const array& a, const person& who);

/// Returns factors on amplitudes by tactor; empty if all are 1.
/// \throws error (bad_input) as predict_percept() does.
std::vector<double> person_gains(const array& a, const person& who);

} // namespace tactor::detail
