// SPDX-License-Identifier: MIT
/// \file
/// Whether the masking noise hides the array: somebody listens, and sets the amplifier.
#pragma once

#include "cli/experiment/experiment_options.hpp"
#include "cli/settings.hpp"
#include "study/session/prepared.hpp"

namespace tactor::cli {

/// --check-noise: the definition's noise, and its stimuli under it, by keys. Returns the exit status. \throws
/// error.
int check_noise(const study::prepared_experiment& p, const experiment_options& o, const settings& s);

} // namespace tactor::cli
