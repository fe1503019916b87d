// SPDX-License-Identifier: MIT
/// \file
/// An experiment on an array, for a participant: all that can be settled and checked before the session; the
/// lines of its trials, and the place of a session that goes on; and a session with a simulated observer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <tactor/array.hpp>
#include <tactor/render.hpp>

#include "session/environment.hpp"
#include "study/bids/session_store.hpp"
#include "study/experiment/definition.hpp"
#include "study/experiment/simulated.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/code_numbers.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

/// Kind of participant.
enum class audience {
    person,
    observer, ///< a simulated one
    nobody,   ///< a dry run
};

/// Hand that wears the array.
enum class hand_kind { left, right };

/// Request for a session.
struct session_request {
    std::string definition = {};            ///< a name that is built in, or a file
    std::string participant = {};           ///< empty only of a dry run
    std::optional<std::uint64_t> seed = {}; ///< else that of the definition, else one of the participant's
    audience who = audience::person;
    std::optional<hand_kind> hand = {};  ///< none: not said
    std::string group = {};              ///< of the definition's groups; empty: none is named
    std::optional<std::size_t> row = {}; ///< of the orders, from 1; none: default_row()
    session_number session = {};         ///< of the definition's sessions; none: none is named
    bool all_sessions = false;           ///< needs no number
};

struct prepared_experiment {
    experiment_definition definition;
    std::string participant;
    std::uint64_t seed = 0;
    session::environment where; ///< its array has thresholds where the level is a sensation level
    std::string pcm;            ///< "null" where nothing names one
    render_options render;
    bool assumed = false; ///< thresholds that nobody measured
    std::vector<run_sequence> runs;
    stimulus_set stimuli;
    std::vector<std::string> warnings;
    std::vector<std::string> calibration_doubts; ///< of the warnings, those about the thresholds' origin
    std::optional<hand_kind> hand = {};          ///< motions that say so are mirrored for a left one
    std::size_t row = 1;                         ///< of the orders, from 1
    code_numbers codes = {};                     ///< empty without [sync] code

    /// Returns the run at a place in the session's order.
    const run_definition& run_at(std::size_t place) const { return definition.runs[runs[place].run]; }
};

/// Settles a session. \throws error (bad_input): the definition, array or configuration is wrong, the group,
/// session or row is not the definition's, a stimulus cannot be planned or played, or a session with a person
/// has no thresholds.
prepared_experiment prepare(const session_request& r, session::settings& s);

/// Makes the score of one tactor at the carrier of the definition's first method. \throws error (bad_input)
/// if its level is too high, in the definition's words.
score walk_score(const experiment_definition& d, const array& a, const render_options& o, unsigned tactor);

/// Time from the screen before to the first frame of a stimulus, so that it surprises nobody, s.
inline constexpr double stimulus_lead_s = 0.5;

/// Returns the time from the end of the rest before a trial to its first frame: the target, if the run shows
/// it, and the time after it.
double find_lead_s(const prepared_experiment& p, const run_definition& r, const planned_trial& t);

struct run_time {
    double total_s = 0.0;  ///< practice included, the break after the run not
    double waits_s = 0.0;  ///< part of total_s: waits for the limits of drive time
    std::size_t waits = 0; ///< trials that wait
};

/// Returns the time of each run in the session's order. Answers take no time, the device adds no latency, and
/// the array has rested before.
std::vector<run_time> session_times(const prepared_experiment& p);

/// Returns the facts that session.json has before a session begins.
nlohmann::ordered_json describe_session(const prepared_experiment& p,
                                        const std::optional<simulation>& simulate, const std::string& masker);

/// Return parts of these facts: a level; the definition's noise, null for none; each stimulus with its hash,
/// and its level if that is its method's.
nlohmann::ordered_json level_facts(const render_options& o);
nlohmann::ordered_json masking_facts(const masking_definition& m);
nlohmann::ordered_json stimulus_facts(const prepared_experiment& p);

/// Returns a trial's line, as far as the plan of the session determines it.
trial_row planned_row(const prepared_experiment& p, const planned_trial& t, const pending_trial& which);

/// Writes an answer, and the time until it came, into the columns of the response.
void set_response(trial_row& row, const run_definition& r, double response, double time_s);

/// Returns the rest of a run after the lines that are there. \throws error (bad_input) for lines that are not
/// of this session.
run_queue replay(const prepared_experiment& p, const run_sequence& s, const std::vector<trial_row>& rows);

/// Returns true if all trials of all runs are there, and the answers to all questionnaires. Throws as above.
bool finished(const prepared_experiment& p, const session_store& store);

/// Makes the flow at the place where the session is. Only one with a person has consent and walk.
session_flow make_flow(const prepared_experiment& p, const session_store& store, bool with_person);

/// Returns the name of the run before a questionnaire that is asked between runs; empty for others.
std::string name_run_before(const prepared_experiment& p, const questionnaire& q, std::size_t run);

/// Lines of one run, or of its practice, with times that count from its first sample at the DAC.
class run_table {
public:
    /// Goes on after the lines that are there.
    run_table(session_store& store, const run_definition& r, bool practice);

    /// Sets the onset and writes the line; it is on the disk when this returns. `started_ns` is
    /// CLOCK_REALTIME at the trial's first frame, or at its planned begin. \throws error (runtime).
    void add(trial_row row, std::int64_t started_ns, unsigned rate);
    /// Returns the time of a frame since the run's first sample: exact within a stream; over the gap between
    /// two streams by `at_ns`, its CLOCK_REALTIME. Call it after add().
    double onset_s(unsigned stream, std::uint64_t frame, std::int64_t at_ns, unsigned rate) const;

private:
    session_store& store_;
    const run_definition& run_;
    bool practice_;
    bool empty_ = true;
    unsigned first_stream_ = 0;
    std::optional<std::uint64_t> first_frame_ = {}; ///< of that stream
    std::optional<std::int64_t> began_ns_ = {};     ///< CLOCK_REALTIME
};

/// A run while it is held: its tables, and the values that its answers so far choose.
class held_run {
public:
    /// Goes on after the lines that are there.
    held_run(const prepared_experiment& p, std::size_t place, session_store& store);

    /// Returns the trial of a step, with its value.
    planned_trial find_trial(const session_step& s) const;
    /// Writes the line of a trial, and lets its answer choose values: run_table::add().
    void add(const session_step& s, const trial_row& row, std::int64_t started_ns);
    const run_table& table(const session_step& s) const { return s.practice ? practice_ : trials_; }

private:
    const prepared_experiment& p_;
    const run_sequence& sequence_;
    run_table practice_;
    run_table trials_;
    std::unique_ptr<value_chooser> values_;
};

/// Holds the rest of a session without a device: a model answers, and no time passes. Returns the signal that
/// ended it, or 0. \throws error.
int simulate_session(const prepared_experiment& p, const simulation& s, session_store& store);

} // namespace tactor::study
