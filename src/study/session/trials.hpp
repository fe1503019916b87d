// SPDX-License-Identifier: MIT
/// \file
/// Parts of simulated and real sessions: lines of trials, and the place of a session that goes on.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "study/bids/session_store.hpp"
#include "study/experiment/simulated.hpp"
#include "study/session/prepared.hpp"

namespace tactor::study {

/// Returns a trial's line, as far as the plan of the session determines it.
trial_row planned_row(const prepared_experiment& p, const planned_trial& t, const pending_trial& which);

/// Writes an answer, and the time until it came, into the columns of the response.
void set_response(trial_row& row, const prepared_experiment& p, const run_definition& r, unsigned response,
                  double time_s);

/// Returns the rest of a run after the lines that are there. \throws error (bad_input) for lines that are not
/// of this session.
run_queue replay(const prepared_experiment& p, const run_sequence& s, const std::vector<trial_row>& rows);

/// Returns true if all trials of all runs are there. Throws as above.
bool finished(const prepared_experiment& p, const session_store& store);

/// Makes the flow at the place where the session is. Only one with a person has consent and walk.
session_flow make_flow(const prepared_experiment& p, const session_store& store, bool with_person);

/// Returns the trial of a step.
const planned_trial& find_trial(const prepared_experiment& p, const session_step& s);

/// Lines of one run, or of its practice, with times that count from its first sample at the DAC.
class run_table {
public:
    /// Goes on after the lines that are there.
    run_table(session_store& store, const run_definition& r, bool practice);

    /// Sets the onset and writes the line; it is on the disk when this returns. `started_ns` is
    /// CLOCK_REALTIME at the trial's first frame, or at its planned begin. \throws error (runtime).
    void add(trial_row row, std::int64_t started_ns, unsigned rate);

private:
    session_store& store_;
    const run_definition& run_;
    bool practice_;
    bool empty_ = true;
    unsigned first_stream_ = 0;
    std::optional<std::uint64_t> first_frame_ = {}; ///< of that stream
    std::optional<std::int64_t> began_ns_ = {};     ///< CLOCK_REALTIME
};

/// Both tables of a run.
struct run_tables {
    run_table practice;
    run_table trials;

    run_tables(session_store& store, const run_definition& r)
        : practice(store, r, true), trials(store, r, false)
    {
    }
    run_table& at(const session_step& s) { return s.practice ? practice : trials; }
};

/// Holds the rest of a session without a device: a model answers, and no time passes. Returns the signal that
/// ended it, or 0. \throws error.
int simulate_session(const prepared_experiment& p, const simulation& s, session_store& store);

} // namespace tactor::study
