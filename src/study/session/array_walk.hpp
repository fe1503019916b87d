// SPDX-License-Identifier: MIT
/// \file
/// The walk over the array before the runs: each tactor once, which the participant is to feel.
#pragma once

#include <tactor/array.hpp>
#include <tactor/render.hpp>

#include "study/experiment/definition.hpp"

namespace tactor::study {

/// A tactor by itself, at the carrier of the definition's first method. \throws error (bad_input) where its
/// level is too high, in the definition's words.
score walk_score(const experiment_definition& d, const array& a, const render_options& o, unsigned tactor);

/// Tries all of them. Throws as above.
void check_walk(const experiment_definition& d, const array& a, const render_options& o);

} // namespace tactor::study
