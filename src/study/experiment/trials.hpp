// SPDX-License-Identifier: MIT
/// \file
/// The trials of an experiment: the order of a participant's runs and of the trials in each, the same on
/// every machine; the next step of a session, by what has happened; and the stimuli, each motion by each
/// method that a run asks for, planned and checked before the session. Values, without a device, a clock or a
/// display.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "study/experiment/definition.hpp"

namespace tactor::study {

/// Motion and methods are places in those of the definition.
struct planned_trial {
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::optional<std::size_t> method_2 = {}; ///< none: one stimulus
    double rest_s = 0.0;                      ///< pause before it
    unsigned track = 0;                       ///< adaptive: from 1; set_value() gives the trial its value

    friend bool operator==(const planned_trial&, const planned_trial&) = default;
};

struct run_sequence {
    std::size_t run = 0;                      ///< its place in the definition
    std::vector<planned_trial> practice = {}; ///< before the others, which count
    std::vector<planned_trial> trials = {};   ///< trial 1 is the first

    friend bool operator==(const run_sequence&, const run_sequence&) = default;
};

/// Gives a trial of an adaptive run a value, by its place in those of the run.
void set_value(planned_trial& t, const run_definition& r, std::size_t place);

/// Returns the value of a trial's comparison; none: the run varies nothing, or the trial has no stimulus.
std::optional<double> find_value(const experiment_definition& d, const planned_trial& t);

/// Returns the seed for a participant without one: the first four bytes of the code's SHA-256.
std::uint64_t default_seed(std::string_view code);

/// Returns the number of rows of the square for n runs or blocks; 1 if the order is random.
std::size_t square_rows(std::string_view order, std::size_t n) noexcept;

/// Returns a row of the square, from 0. williams: over all rows each of the n follows each other equally
/// often. latin: a row is the one before, moved on by one. \pre `order` is not random.
std::vector<std::size_t> square_row(std::string_view order, std::size_t n, std::size_t row);

/// Returns the number of rows of a definition: over them each order of the runs meets each order of the
/// blocks in a run.
std::size_t count_rows(const experiment_definition& d);

/// Returns "seed/experiment/code", in a study with several sessions "seed/experiment/code/ses-N".
std::string session_seed(std::uint64_t seed, const experiment_definition& d, std::string_view code);

/// Returns the row of a participant, from 1: the number at the code's end, or without a number
/// default_seed() plus 1; each later session has the next row; after the last row the first one comes again.
std::size_t default_row(const experiment_definition& d, std::string_view code);

/// Draws the trials of one run from the generator that session_seed() and "/run" seed: each motion with each
/// method, or with each pair of methods in each order, equally often as far as their number allows.
/// No motion comes more than max_in_a_row times in a row. `row` orders the blocks; none: default_row().
run_sequence make_run(const experiment_definition& d, std::size_t run, std::string_view code,
                      std::uint64_t seed, std::optional<std::size_t> row = {});

/// Draws all runs, in the participant's order; a random one is from the generator that session_seed() seeds.
std::vector<run_sequence> make_sequence(const experiment_definition& d, std::string_view code,
                                        std::uint64_t seed, std::optional<std::size_t> row = {});

/// A trial of a run that is to come.
struct pending_trial {
    unsigned trial = 1;
    unsigned attempt = 1;

    friend bool operator==(const pending_trial&, const pending_trial&) = default;
};

/// The rest of a run: its trials in order, and behind them those that were void.
class run_queue {
public:
    explicit run_queue(std::size_t trials)
    {
        for (std::size_t i = 0; i < trials; ++i)
            all_.push_back({static_cast<unsigned>(i + 1), 1});
    }

    bool done() const noexcept { return at_ >= all_.size(); }
    /// The next trial; there must be one.
    pending_trial next() const { return all_.at(at_); }
    /// Takes the next trial, which was played; where it was void it comes again.
    void take(bool is_void)
    {
        const pending_trial t = all_.at(at_++);
        last_counts_ = !is_void;
        if (is_void)
            all_.push_back({t.trial, t.attempt + 1});
    }
    /// Takes back the last trial that was taken and counted: it comes again. False where there is none.
    bool take_back()
    {
        if (!last_counts_)
            return false;
        const pending_trial t = all_.at(at_ - 1);
        last_counts_ = false;
        all_.push_back({t.trial, t.attempt + 1});
        return true;
    }

private:
    std::vector<pending_trial> all_ = {};
    std::size_t at_ = 0;
    bool last_counts_ = false;
};

/// Kind of the next step.
enum class step_kind {
    consent,   ///< the text is shown: agree()
    walk,      ///< a tactor is driven: felt() or walk_back()
    introduce, ///< the run's question is shown: go_on()
    trial,     ///< a trial is played and answered: took()
    rest,      ///< a break between runs: go_on()
    pause,     ///< the experimenter's: go_on()
    ask,       ///< an item of a questionnaire is asked: answered()
    over,      ///< all runs are through
};

struct session_step {
    step_kind what = step_kind::over;
    unsigned tactor = 0;      ///< of the walk
    std::size_t run = 0;      ///< place in the order of the session: from introduce to rest
    bool practice = false;    ///< the trial does not count
    pending_trial which = {}; ///< of practice the attempt is always 1
    std::size_t form = 0;     ///< to ask: place in the definition's questionnaires
    std::size_t item = 0;     ///< place in the form

    friend bool operator==(const session_step&, const session_step&) = default;
};

/// A run at the place where the session begins or goes on.
struct flow_run {
    unsigned practice = 0;  ///< trials that do not count
    unsigned practised = 0; ///< how many of them are over
    run_queue trials;
    bool rest = false; ///< a break follows, unless it is the last
};

/// A questionnaire at a place of the session.
struct flow_form {
    std::size_t form = 0; ///< place in the definition's questionnaires
    questionnaire_time when = questionnaire_time::before;
    std::size_t run = 0; ///< between: place of the run before it
    std::size_t items = 1;
    std::size_t answered = 0; ///< how many of them have an answer

    bool done() const noexcept { return answered == items; }
};

/// Number of void trials in a row that makes a pause, so that somebody looks.
inline constexpr unsigned most_void_in_row = 5;

class session_flow {
public:
    /// Passes over runs that are done. A walk over `tactors` comes first.
    session_flow(std::vector<flow_run> runs, bool consent, unsigned tactors,
                 std::vector<flow_form> forms = {});

    session_step next() const;

    void agree() noexcept { ask_consent_ = false; }
    void felt() noexcept { ++walked_; }
    void walk_back() noexcept { walked_ -= walked_ > 0 ? 1 : 0; }
    void go_on();
    /// Takes a trial that is over and on the disk.
    void took(bool is_void);
    /// Takes an item whose answer is on the disk: that of step_kind::ask.
    void answered(const session_step& s);
    /// Returns true if an item was answered since the last trial, and the next step waits for somebody.
    bool can_go_back() const;
    /// Asks the last such item again. Returns false if there is none.
    bool go_back();

    /// Makes the last trial that counted void: it comes again at the end of its run, which is void_run()
    /// before this call. Returns false if none can be made void: there was none in this session, it is void
    /// already, the next run has begun, or a questionnaire is being asked.
    bool void_last();
    std::size_t void_run() const noexcept { return last_run_; }
    /// Puts a pause before the next trial.
    void pause() noexcept { paused_ = true; }
    /// Returns true within a questionnaire.
    bool is_asking() const;

private:
    enum class place { introduce, trials, rest };

    /// Returns true if the questionnaire comes now.
    bool is_due(const flow_form& f) const;
    /// Goes to the next run with trials left, if the present one has none.
    void leave_done_run(bool rest);

    std::vector<flow_run> runs_;
    bool ask_consent_;
    unsigned tactors_;
    std::vector<flow_form> forms_;
    std::vector<std::size_t> answered_ = {}; ///< forms of the items answered since the last trial, in order
    unsigned walked_ = 0;
    std::size_t run_ = 0;
    place place_ = place::introduce;
    bool paused_ = false;
    std::size_t last_run_ = 0;
    bool has_last_ = false; ///< a trial was taken that void_last() may still reach
    unsigned void_in_row_ = 0;
};

struct stimulus {
    std::size_t motion = 0; ///< places in the definition
    std::size_t method = 0;
    tactor::plan plan = {};
    render_options render = {};        ///< the session's, with those that the method gives
    double weakened_db = 0.0;          ///< how much weaker than its level it is, see weakening
    std::uint64_t frames = 0;          ///< from its first frame to its last sound's end
    std::string text = {};             ///< the plan as tactor-plan/1
    std::string hash = {};             ///< its SHA-256
    percept_summary felt = {};         ///< predicted
    std::vector<point> felt_path = {}; ///< predicted, at equal parts of the time
};

/// Number of equal parts in which movements are compared.
inline constexpr std::size_t path_parts = 100;

class stimulus_set {
public:
    /// Plans, predicts and checks all stimuli; keeps each warning of the planner once, and warns of methods
    /// that make one stimulus of a motion. `o`: the session's, for what a method does not give.
    /// \throws error (bad_input) with the line of what the definition says there, a run's values, an option
    /// of
    ///         a method, or else the motion: it cannot be planned, or a level is too high.
    stimulus_set(const experiment_definition& d, const array& a, const render_options& o);

    /// Returns a stimulus that a run asks for.
    const stimulus& at(std::size_t motion, std::size_t method) const;
    /// Lists all stimuli, in the order of the runs.
    const std::vector<stimulus>& all() const noexcept { return all_; }
    const std::vector<std::string>& warnings() const noexcept { return warnings_; }

    /// Return the frames of a trial, the gap included, and the frame at which the second stimulus begins.
    std::uint64_t frames(const planned_trial& t) const;
    std::uint64_t second(const planned_trial& t) const;
    /// Returns both stimuli in one score, exact to the frame, each with its own sound. A renderer applies the
    /// limits, if any.
    score make_score(const planned_trial& t, const std::optional<drive_limits>& limits = {}) const;

private:
    const stimulus* find(std::size_t motion, std::size_t method) const noexcept;
    /// `vary`: what the values of the run are of, if it has any.
    stimulus make(const experiment_definition& d, std::size_t motion, std::size_t method,
                  std::string_view vary, const layout& faces);
    void warn_of_same(const experiment_definition& d);

    array array_;
    render_options options_;
    std::uint64_t gap_frames_ = 0;
    std::vector<stimulus> all_ = {};
    std::vector<std::string> warnings_ = {};
};

} // namespace tactor::study
