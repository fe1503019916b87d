// SPDX-License-Identifier: MIT
/// \file
/// [limits] held against an experiment's trials, before anybody sits down.
#pragma once

#include <vector>

#include <tactor/render.hpp>

#include "study/experiment/definition.hpp"
#include "study/experiment/sequence.hpp"
#include "study/experiment/stimuli.hpp"

namespace tactor::study {

/// Each trial that there is, practice too, must sound as planned on an array that has rested.
/// \throws error (bad_input) with the motion's line for one that a limit would change: it would be void
///         whenever it comes.
void check_limits(const experiment_definition& d, const std::vector<run_sequence>& runs,
                  const stimulus_set& stimuli, const drive_limits& l);

} // namespace tactor::study
