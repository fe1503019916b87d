// SPDX-License-Identifier: MIT
/// \file
/// What simulated and real sessions share: lines of trials, and where a session that goes on is.
#pragma once

#include <string>
#include <vector>

#include "cli/experiment/prepared.hpp"
#include "study/bids/session_store.hpp"

namespace tactor::cli {

/// A line of a trial, as far as the plan of the session says it.
study::trial_row planned_row(const prepared_experiment& p, const study::planned_trial& t,
                             const study::pending_trial& which);

/// What an answer is in the columns response and rating.
void set_response(study::trial_row& row, const prepared_experiment& p, const study::run_definition& r,
                  unsigned response);

/// What is left of a run after the lines that are there. \throws error (bad_input) for lines that are not of
/// this session.
study::run_queue replay(const prepared_experiment& p, const study::run_sequence& s,
                        const std::vector<study::trial_row>& rows);

/// Whether all trials of all runs are there. Throws as above.
bool finished(const prepared_experiment& p, const study::session_store& store);

} // namespace tactor::cli
