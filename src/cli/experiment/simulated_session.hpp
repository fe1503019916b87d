// SPDX-License-Identifier: MIT
/// \file
/// A session in which a model answers: it opens no device, takes no time and asks nothing.
#pragma once

#include "cli/experiment/prepared.hpp"
#include "study/bids/session_store.hpp"

namespace tactor::cli {

/// All trials that are left. Returns the signal that ended it, or 0. \throws error.
int simulate_session(const prepared_experiment& p, const study::simulation& s, study::session_store& store);

} // namespace tactor::cli
