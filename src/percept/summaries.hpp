// SPDX-License-Identifier: MIT
/// \file
/// Several plans of a stroke summed up at once, however long it is.
#pragma once

#include <span>
#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// summarise() of predict_percept() for each plan, to the last bit; no samples are kept, and the target is
/// looked up once for all. \throws error (bad_input) as predict_percept().
std::vector<percept_summary> predict_summaries(const array& a, const stroke& s,
                                               std::span<const plan* const> plans);

} // namespace tactor::detail
