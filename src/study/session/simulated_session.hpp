// SPDX-License-Identifier: MIT
/// \file
/// A session in which a model answers: it opens no device, takes no time and asks nothing.
#pragma once

#include "study/bids/session_store.hpp"
#include "study/experiment/simulated.hpp"
#include "study/session/prepared.hpp"

namespace tactor::study {

/// All trials that are left. Returns the signal that ended it, or 0. \throws error.
int simulate_session(const prepared_experiment& p, const simulation& s, session_store& store);

} // namespace tactor::study
