// SPDX-License-Identifier: MIT
/// \file
/// What a person feels instead of what was meant.
#pragma once

#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// The array with its tactors where they are felt. \throws error (bad_input) as predict_percept() does.
array felt_array(const array& a, const person& who);

/// Factors of amplitudes by tactor; empty where all are 1. \throws error (bad_input) as predict_percept()
/// does.
std::vector<double> gains_of(const array& a, const person& who);

} // namespace tactor::detail
