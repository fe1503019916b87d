// SPDX-License-Identifier: MIT
/// \file
/// A session of an experiment for one participant: its preparation and checks, the lines of its trials, the
/// state from which it resumes, and sessions with a simulated observer.
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
#include "study/data/definition.hpp"
#include "study/experiment/simulated.hpp"
#include "study/experiment/trials.hpp"
#include "study/session/code_numbers.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

/// Kind of participant.
enum class audience {
    person,
    observer, ///< a simulated participant
    nobody,   ///< no participant: a dry run
};

/// Hand that wears the array.
enum class hand_kind { left, right };

/// Request for a session.
struct session_request {
    std::string definition = {};            ///< name of a built-in definition, or path of a file
    std::string participant = {};           ///< code of the participant; may be empty for a dry run
    std::optional<std::uint64_t> seed = {}; ///< default: seed of the definition, or else default_seed()
    audience who = audience::person;
    std::optional<hand_kind> hand = {};  ///< missing if not given
    std::string group = {};              ///< name of a group; empty if not given
    std::optional<std::size_t> row = {}; ///< row in the table of orders, from 1; default: default_row()
    session_number session = {};         ///< number of the session; missing if not given
    bool all_sessions = false;           ///< true to prepare the runs of all sessions; ignores `session`
};

struct prepared_experiment {
    experiment_definition definition;
    std::string participant;
    std::uint64_t seed = 0;
    session::environment where; ///< each tactor has a threshold if a level is relative to thresholds
    std::string pcm;            ///< PCM; "null" for a session without a person
    render_options render;
    bool assumed = false; ///< true if any threshold is assumed, not measured
    std::vector<run_sequence> runs;
    stimulus_set stimuli;
    std::vector<std::string> warnings;
    std::vector<std::string> calibration_doubts; ///< warnings about the origin of the thresholds
    std::optional<hand_kind> hand = {};          ///< motions with `mirror` are mirrored for a left hand
    std::size_t row = 1;                         ///< row in the table of orders, from 1
    code_numbers codes = {};                     ///< empty without [sync] code

    /// Returns the run at a position in the session's order.
    const run_definition& run_at(std::size_t place) const { return definition.runs[runs[place].run]; }
};

/// Prepares and checks a session. \throws error (bad_input) if the definition, array or configuration is
/// invalid, the definition does not have the requested group, session or row, a stimulus cannot be planned or
/// played, or a session with a person needs thresholds that the array does not have.
prepared_experiment prepare(const session_request& r, session::settings& s);

/// Makes the score that drives one tactor in the walk, which tries each tactor before the runs. Uses the
/// carrier of the definition's first method. \throws error (bad_input) if the level is too high. The hint of
/// the error names keys of the definition.
score make_walk_score(const experiment_definition& d, const array& a, const render_options& o,
                      unsigned tactor);

/// Time from the change of the screen to the first frame of a stimulus, s. It lets the participant get ready.
inline constexpr double stimulus_lead_s = 0.5;

/// Returns the time from the end of the rest before a trial to the trial's first frame, s. It is
/// stimulus_lead_s, plus the duration of the target if the run shows the target.
double find_lead_s(const prepared_experiment& p, const run_definition& r, const planned_trial& t);

struct run_time {
    double total_s = 0.0;  ///< duration, including practice but not the break after the run
    double waits_s = 0.0;  ///< part of total_s in which trials wait for the limits of drive time
    std::size_t waits = 0; ///< number of trials that wait
};

/// Estimates the duration of each run, in the session's order. Assumes that answers take no time and change
/// no value, that the device adds no latency, and that the array has rested before the session.
std::vector<run_time> session_times(const prepared_experiment& p);

/// Returns the table line of a trial. Fills only the cells that are known before the trial.
trial_row planned_row(const prepared_experiment& p, const run_definition& r, const planned_trial& t,
                      const pending_trial& which);

/// Sets the first frame of each stimulus that began to play. `begin`: start of each stimulus in frames since
/// the start of the trial. `first_frame`: first frame of the trial. `frames`: number of frames of the trial
/// that were played.
void set_first_frames(trial_row& row, const std::vector<std::uint64_t>& begin,
                      std::optional<std::uint64_t> first_frame, std::uint64_t frames);

/// Sets the response and the response time of a line. Marks the response as early if it came before the run's
/// min_response_s.
void set_response(trial_row& row, const run_definition& r, const trial_answer& response, double time_s);

/// Returns the trials of a run that remain after the lines in its table. \throws error (bad_input) if a line
/// does not belong to this session. `table`: the file for the error.
run_queue replay(const prepared_experiment& p, const run_sequence& s, const std::vector<trial_row>& rows,
                 const std::filesystem::path& table);

/// Makes the flow of a session, starting from the state in the store. Only a flow `with_person` has consent
/// and walk.
session_flow make_flow(const prepared_experiment& p, const session_store& store, bool with_person);

/// Returns the name of the run that precedes a questionnaire between runs. Returns an empty name for other
/// questionnaires.
std::string preceding_run_name(const prepared_experiment& p, const questionnaire& q, std::size_t run);

/// The table of one run or of its practice. Its times are relative to the run's first sample at the DAC.
class run_table {
public:
    /// Continues after the lines that the store already has.
    run_table(session_store& store, const run_definition& r, bool practice);

    /// Sets the onset of a line and writes the line. When this returns, the line is on the disk.
    /// `started_ns`: CLOCK_REALTIME at the trial's first frame, or now if the trial has no first frame.
    /// \throws error (runtime).
    void add(trial_row row, std::int64_t started_ns, unsigned rate);
    /// Returns the time from the run's first sample to a frame, s. The time is exact if the sample and the
    /// frame are in the same stream. If the frame is in a later stream, uses `at_ns`, the frame's
    /// CLOCK_REALTIME. Call it after add().
    double onset_s(unsigned stream, std::uint64_t frame, std::int64_t at_ns, unsigned rate) const;

private:
    session_store& store_;
    const run_definition& run_;
    bool practice_;
    bool empty_ = true;
    unsigned first_stream_ = 0;
    std::optional<std::uint64_t> first_frame_ = {}; ///< run's first frame in stream first_stream_
    std::optional<std::int64_t> began_ns_ = {};     ///< start of the run, CLOCK_REALTIME
};

/// A run in progress: its tables, and the values that an adaptive procedure chooses from the answers.
class held_run {
public:
    /// Continues after the lines that the store already has.
    held_run(const prepared_experiment& p, std::size_t place, session_store& store);

    /// Returns the trial of a step, with the value that an adaptive procedure chooses, if any.
    planned_trial find_trial(const session_step& s) const;
    /// Writes the line of a trial (see run_table::add()) and passes the trial's answer to the adaptive
    /// procedure. Returns true if the answer ended the trial's track.
    [[nodiscard]] bool add(const session_step& s, const trial_row& row, std::int64_t started_ns);
    const run_table& find_table(const session_step& s) const { return s.practice ? practice_ : trials_; }

private:
    const prepared_experiment& p_;
    const run_sequence& sequence_;
    run_table practice_;
    run_table trials_;
    std::unique_ptr<value_chooser> values_;
};

/// Prepares the simulated observer of each run. \throws error (bad_input) if the observer cannot do a run.
void check_simulation(const prepared_experiment& p, const simulation& s);

/// Runs the rest of a session with a simulated observer, without a device and without waiting. Returns the
/// signal that ended the session, or 0. \throws error.
int simulate_session(const prepared_experiment& p, const simulation& s, session_store& store);

} // namespace tactor::study
