// SPDX-License-Identifier: MIT
/// \file
/// What simulated and real sessions share: lines of trials, and where a session that goes on is.
#pragma once

#include <vector>

#include "study/bids/session_store.hpp"
#include "study/session/prepared.hpp"

namespace tactor::study {

/// A line of a trial, as far as the plan of the session says it.
trial_row planned_row(const prepared_experiment& p, const planned_trial& t, const pending_trial& which);

/// What an answer is in the columns response and rating.
void set_response(trial_row& row, const prepared_experiment& p, const run_definition& r, unsigned response);

/// What is left of a run after the lines that are there. \throws error (bad_input) for lines that are not of
/// this session.
run_queue replay(const prepared_experiment& p, const run_sequence& s, const std::vector<trial_row>& rows);

/// Whether all trials of all runs are there. Throws as above.
bool finished(const prepared_experiment& p, const session_store& store);

} // namespace tactor::study
