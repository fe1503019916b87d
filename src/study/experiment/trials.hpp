// SPDX-License-Identifier: MIT
/// \file
/// The trials of an experiment. make_sequence() draws the order of a participant's runs and trials, which is
/// the same on every machine. session_flow finds the next step of a session. stimulus_set plans and checks
/// all stimuli before the session. Nothing here uses a device, clock or display.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "files/plan/plan_json.hpp"
#include "study/data/definition.hpp"

namespace tactor::study {

struct run_sequence {
    std::size_t run = 0;                      ///< index of the run in the definition
    std::vector<planned_trial> practice = {}; ///< practice trials, which come first and do not count
    std::vector<planned_trial> trials = {};   ///< trials that count; the first is trial 1

    friend bool operator==(const run_sequence&, const run_sequence&) = default;
};

/// Returns the default seed of a participant: the first four bytes of the code's SHA-256.
std::uint64_t default_seed(std::string_view code);

/// Returns the number of rows of the Williams or Latin square for n runs or blocks; 1 for a random order.
std::size_t count_square_rows(std::string_view order, std::size_t n) noexcept;

/// Returns a row of the square; rows count from 0. williams: over all rows, each item follows each other item
/// equally often. latin: each row is the previous row shifted by one. \pre `order` is not random.
std::vector<std::size_t> square_row(std::string_view order, std::size_t n, std::size_t row);

/// Returns the number of rows. Each row is a different order for a participant. Over all rows, each order of
/// the runs meets each order of the blocks in a run.
std::size_t count_rows(const experiment_definition& d);

/// Returns "seed/experiment/code", or "seed/experiment/code/ses-N" in a study with several sessions.
std::string session_seed(std::uint64_t seed, const experiment_definition& d, std::string_view code);

/// Returns the row of a participant, from 1: the number at the end of the code, or default_seed() + 1 if the
/// code ends without a number. Each later session uses the next row; the first row follows the last.
std::size_t default_row(const experiment_definition& d, std::string_view code);

/// Draws the trials of one run. The seed is session_seed() and the run's name. Combines each motion with each
/// method, or with each pair of methods in both orders, as evenly as the number of trials allows.
/// No motion comes more than max_in_a_row times in a row. `row` determines the order of the blocks; if it is
/// missing, default_row() applies.
run_sequence make_run(const experiment_definition& d, std::size_t run, std::string_view code,
                      std::uint64_t seed, std::optional<std::size_t> row = {});

/// Draws all runs, in the participant's order. The seed of a random order is session_seed().
std::vector<run_sequence> make_sequence(const experiment_definition& d, std::string_view code,
                                        std::uint64_t seed, std::optional<std::size_t> row = {});

/// A trial that is still to come.
struct pending_trial {
    unsigned trial = 1;
    unsigned attempt = 1;

    friend bool operator==(const pending_trial&, const pending_trial&) = default;
};

/// Queue of the remaining trials of a run: first the trials not yet played, in order, and then the void
/// trials. Skips the trials of tracks that have ended.
class run_queue {
public:
    explicit run_queue(const std::vector<planned_trial>& trials)
    {
        for (const planned_trial& t : trials) {
            tracks_.push_back(t.track);
            all_.push_back({static_cast<unsigned>(tracks_.size()), 1});
        }
    }

    bool done() const noexcept { return at_ >= all_.size(); }
    /// Returns the next trial. \pre !done()
    pending_trial next() const { return all_.at(at_); }
    /// Removes the next trial after it was played. A void trial comes again at the end. `ends_track`: true if
    /// the answer ended the trial's track.
    void remove_next(bool is_void, bool ends_track = false)
    {
        last_ = at_;
        last_counts_ = !is_void;
        if (ends_track)
            ended_.insert(find_track(last_));
        advance_to_next_trial();
    }
    /// Queues the last trial again, and no longer counts it. If the trial ended its track, the track goes on.
    /// Returns false if there is no last trial, or the last trial does not count.
    bool requeue_last()
    {
        if (!last_counts_)
            return false;
        last_counts_ = false;
        ended_.erase(find_track(last_));
        advance_to_next_trial();
        return true;
    }

private:
    unsigned find_track(std::size_t place) const { return tracks_.at(all_.at(place).trial - 1); }
    void advance_to_next_trial()
    {
        const pending_trial last = all_.at(last_);
        if (!last_counts_)
            all_.push_back({last.trial, last.attempt + 1});
        at_ = last_ + 1;
        while (!done() && ended_.contains(find_track(at_)))
            ++at_;
    }

    std::vector<unsigned> tracks_ = {}; ///< track of each trial; 0 if the trial has no track
    std::vector<pending_trial> all_ = {};
    std::size_t at_ = 0;
    std::size_t last_ = 0; ///< place of the last trial that was played
    bool last_counts_ = false;
    std::set<unsigned> ended_ = {}; ///< tracks that have ended
};

/// Kind of the next step, with the function to call after it.
enum class step_kind {
    consent,   ///< shows the consent text, then record_consent()
    walk,      ///< drives one tactor, then record_felt_tactor() or return_to_last_tactor()
    introduce, ///< shows the run's question, then go_on()
    trial,     ///< plays a trial and asks for the answer, then record_trial()
    rest,      ///< waits during a break between runs, then go_on()
    pause,     ///< waits for the experimenter, then go_on()
    ask,       ///< asks an item of a questionnaire, then record_answer()
    over,      ///< no step remains
};

struct session_step {
    step_kind what = step_kind::over;
    unsigned tactor = 0;      ///< tactor that the walk drives
    std::size_t run = 0;      ///< index in the session's order of runs
    bool practice = false;    ///< true if the trial does not count
    pending_trial which = {}; ///< trial to play; in practice the attempt is always 1
    std::size_t form = 0;     ///< index of the questionnaire to ask, in the definition
    std::size_t item = 0;     ///< index of the item to ask, in the questionnaire

    friend bool operator==(const session_step&, const session_step&) = default;
};

/// State of a run when the session starts or resumes.
struct flow_run {
    unsigned practice = 0;  ///< number of practice trials, which do not count
    unsigned practised = 0; ///< number of practice trials that are over
    run_queue trials;
    bool rest = false; ///< true if a break follows the run, unless it is the last
};

/// A questionnaire at its place in the session.
struct flow_form {
    std::size_t form = 0; ///< index into the definition's questionnaires
    questionnaire_time when = questionnaire_time::before;
    std::size_t run = 0; ///< index of the run before it, if the questionnaire comes between runs
    std::size_t items = 1;
    std::size_t answered = 0; ///< number of items with an answer

    bool done() const noexcept { return answered == items; }
};

/// Number of void trials in a row after which the session pauses, so that somebody looks for the cause.
inline constexpr unsigned most_void_in_row = 5;

class session_flow {
public:
    /// Starts at the first run that is not done. `tactors`: number of tactors in the walk before the runs.
    session_flow(std::vector<flow_run> runs, bool consent, unsigned tactors,
                 std::vector<flow_form> forms = {});

    session_step next() const;

    void record_consent() noexcept { ask_consent_ = false; }
    void record_felt_tactor() noexcept { ++walked_; }
    void return_to_last_tactor() noexcept { walked_ -= walked_ > 0 ? 1 : 0; }
    void go_on();
    /// Records that the present trial is over. Call it when the trial's line is on the disk. `ends_track`:
    /// see run_queue.
    void record_trial(bool is_void, bool ends_track = false);
    /// Records that an item is answered. Call it when the answer is on the disk. `s`: the step that asked the
    /// item.
    void record_answer(const session_step& s);
    /// Returns true if an item was answered since the last trial, and the next step waits for the
    /// participant.
    bool can_go_back() const;
    /// Makes next() ask the last answered item again. Returns false if can_go_back() is false.
    bool go_back();

    /// Makes the last trial void, so that it comes again at the end of its run (see last_trial_run()).
    /// Returns false if this session had no trial, the last trial is already void, the next run has begun, or
    /// a questionnaire is being asked.
    bool void_last_trial();
    std::size_t last_trial_run() const noexcept { return last_run_; }
    /// Adds a pause before the next trial.
    void pause() noexcept { paused_ = true; }
    /// Returns true while a questionnaire is being asked.
    bool is_asking() const;

private:
    enum class place { introduce, trials, rest };

    /// Returns true if the questionnaire is due now.
    bool is_due(const flow_form& f) const;
    /// Moves to the next run that has trials left, if the present run has none. `rest`: true to stop first
    /// for the break after a run, if there is one.
    void skip_finished_runs(bool rest);

    std::vector<flow_run> runs_;
    bool ask_consent_;
    unsigned tactors_;
    std::vector<flow_form> forms_;
    std::vector<std::size_t> answered_ = {}; ///< index in forms_ of each item answered since the last trial
    unsigned walked_ = 0;
    std::size_t run_ = 0;
    place place_ = place::introduce;
    bool paused_ = false;
    std::size_t last_run_ = 0;
    bool has_last_ = false; ///< true if void_last_trial() may still reach the last trial
    unsigned void_in_row_ = 0;
};

struct stimulus {
    std::size_t motion = 0; ///< index in the definition
    std::size_t method = 0;
    files::piece made = {};     ///< strokes, and a plan for each
    render_options render = {}; ///< options of the method, or else of the session
    double weakened_db = 0.0;   ///< reduction of the level, see weakening
    std::uint64_t frames = 0;   ///< length from the first frame to the end of the last sound
    std::string text = {};      ///< plans as tactor-plan/1 or tactor-plans/1
    std::string hash = {};      ///< SHA-256 of `text`
    percept_summary felt = {};  ///< predicted percept of all strokes, as if each were played alone
    /// Predicted positions of each stroke at path_parts + 1 equally spaced times.
    std::vector<std::vector<point>> felt_paths = {};
};

class stimulus_set {
public:
    /// Plans, predicts and checks all stimuli. Keeps each warning of the planner once, and warns if two
    /// methods make the same stimulus of a motion. `o`: the session's options, which a method may replace.
    /// \throws error (bad_input) if a stimulus cannot be planned or a level is too high. The error names the
    ///         line of the run's values or of the method's option, or else of the motion.
    stimulus_set(const experiment_definition& d, const array& a, const render_options& o);

    /// Returns the stimulus of a motion and a method. \pre A run plays this motion with this method.
    const stimulus& at(std::size_t motion, std::size_t method) const;
    /// Lists all stimuli, in the order of the runs.
    const std::vector<stimulus>& all() const noexcept { return all_; }
    const std::vector<std::string>& warnings() const noexcept { return warnings_; }

    /// Returns the length of a trial including the gaps, in frames.
    std::uint64_t count_frames(const planned_trial& t) const;
    /// Returns the start of each stimulus of a trial, in frames.
    std::vector<std::uint64_t> starts(const planned_trial& t) const;
    /// Returns the stimuli of a trial in one score, exact to the frame, each with its own render options. The
    /// renderer applies `limits`, if any.
    score make_score(const planned_trial& t, const std::optional<drive_limits>& limits = {}) const;

private:
    const stimulus* find(std::size_t motion, std::size_t method) const noexcept;
    /// Plans and predicts one stimulus. `vary`: option or stroke parameter that the run varies, if any.
    stimulus make(const experiment_definition& d, std::size_t motion, std::size_t method,
                  std::string_view vary, const layout& faces);
    /// Predicts how each stroke feels, as if it were played alone.
    void predict(stimulus& s, const motion_definition& motion, const method_definition& method) const;
    void add_duplicate_warnings(const experiment_definition& d);

    array array_;
    render_options options_;
    std::uint64_t gap_frames_ = 0;
    std::vector<stimulus> all_ = {};
    std::vector<std::string> warnings_ = {};
};

} // namespace tactor::study
