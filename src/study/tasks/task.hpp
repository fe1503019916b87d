// SPDX-License-Identifier: MIT
/// \file
/// Tasks of a study. Each task is a file in this folder with one object. The object defines everything that
/// is special about the task's runs. list_tasks() lists the objects. They have no state, and any thread may
/// use them.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <tactor/path.hpp>

#include "files/toml_reader.hpp"
#include "study/data/definition.hpp"
#include "study/data/drawing.hpp"
#include "study/data/text_table.hpp"
#include "study/data/trial.hpp"
#include "study/random/random.hpp"
#include "study/results/cells.hpp"
#include "study/results/measures.hpp"
#include "study/results/result.hpp"

namespace tactor::study {

struct model_factors;

/// Answers that a participant may give in a trial.
struct trial_answers {
    unsigned lowest = 1;                     ///< number of the first answer
    std::vector<std::string> labels = {};    ///< label of each answer; empty text if the number is enough
    std::string possible = {};               ///< all answers for a terminal, such as "1 or 2"
    bool is_line = false;                    ///< true if answers are places on a line without numbers
    bool is_estimate = false;                ///< true for a number above 0; other members are unused
    drawing_kind draws = drawing_kind::none; ///< kind of drawing, if any; other members are unused
    bool names_stimuli = false;              ///< true if the labels name the stimuli of the trial
    std::string keys = {};                   ///< key of each answer; empty if the numbers are the keys
    bool shows_motions = false;              ///< true if answers are the run's motions, which a page draws
};

/// Procedure that chooses the values of trials from earlier answers. This base class does not change values.
class value_chooser {
public:
    virtual ~value_chooser() = default;
    /// Sets the value of a trial.
    virtual void choose(planned_trial&) {}
    /// Takes the answer to a trial of a track. `method_1`: name of the first stimulus's method.
    virtual void record_answer(unsigned /*track*/, std::string_view /*method_1*/, unsigned /*response*/) {}
    /// Returns true if the answers so far have ended a track. \pre the track has an answer.
    virtual bool has_ended(unsigned /*track*/) const { return false; }
};

/// A simulated observer: seed, noise and true values.
struct simulation {
    std::uint64_t seed = 1;
    double sigma = 1.0; ///< sd of the noise, in -ln cost (choose, rate), or in mm (identify,
                        ///< locate, trace)
    double voids = 0.0; ///< share of trials that are void, as if an xrun occurred
    // True values of the figures that tasks estimate: one for all methods, or one for each method of a run.
    std::vector<double> pse = {}; ///< value felt as equal; if empty, the standard or the middle value
    std::vector<double> jnd = {}; ///< half the range from 25 to 75 %; if empty, a tenth of the values' range
    std::vector<double> dprime = {1.0};
    std::vector<double> exponent = {1.0}; ///< exponent of estimates, whose logarithm has the noise sigma
    double lapse = 0.0;                   ///< share of trials answered by a random key
    // Standard deviations between participants; see simulated_run.
    double pse_sd = 0.0;
    double jnd_sd = 0.0;
    double dprime_sd = 0.0;
    double exponent_sd = 0.0;
    double correlation = 1.0; ///< correlation of a person's four deviations between methods
    double group_d = 0.0;     ///< difference of the last group from the first, in these standard deviations;
                              ///< the groups between them are evenly spaced
    double method_sd = 0.0;   ///< standard deviation of a method's worth, in the unit of sigma (choose, rate)

    friend bool operator==(const simulation&, const simulation&) = default;
};

/// Deviations of a simulated person's figures from the mean of all people, in standard deviations.
struct simulated_figures {
    double pse = 0.0;
    double jnd = 0.0;
    double dprime = 0.0;
    double exponent = 0.0;
};

/// Deviations of a simulated person from the mean of all people, in standard deviations.
struct simulated_person {
    simulated_figures figures = {}; ///< deviations common to all methods
    double group = 0.0;             ///< deviation of the person's group, the same for all figures
    std::vector<simulated_figures> figures_by_method = {}; ///< further deviations for each method
    std::vector<double> methods = {};                      ///< deviation of the worth of each method
};

/// Information about a run for a simulated observer.
struct simulated_run {
    const simulation& truth;
    const experiment_definition& definition;
    const run_definition& run;
    /// Returns the predicted error or unevenness of a stimulus. \throws error if the stimulus is not felt.
    std::function<double(std::size_t motion, std::size_t method)> cost;
    /// Returns the path on which each stroke of a stimulus is felt, at equal time steps.
    std::function<const std::vector<std::vector<point>>&(std::size_t motion, std::size_t method)> felt_paths;
    simulated_person person = {};
    double mean_utility = 0.0;                                 ///< rate: mean of -ln cost over the stimuli
    std::vector<std::vector<std::vector<point>>> targets = {}; ///< for identify: paths by motion and stroke
};

/// Main comparison of a run.
struct main_comparison {
    std::string text;
    std::optional<double> against = {}; ///< missing if there is nothing to compare with
    double rounding = 0.0;              ///< see varies()
};

/// Data of a participant for the main comparison of a run.
struct compared_person {
    std::optional<double> value = {};             ///< missing if the participant is left out
    std::optional<difference_counts> counts = {}; ///< only for task same-different
    std::optional<right_count> right = {};        ///< only for task oddity
};

/// Outcome of the main comparison of a study.
struct compared {
    std::optional<double> p = {}; ///< missing if a test is not possible
    bool is_above = false;        ///< true if the mean is above main_comparison::against
};

/// The highest rating, or "vas".
using rating_scale = std::variant<unsigned, std::string>;

using named_texts = std::vector<std::pair<std::string_view, std::string>>;

class task {
public:
    /// A task's texts for definitions and descriptions.
    struct facts {
        std::string_view name;
        std::string_view trial;    ///< description of a trial
        std::string_view response; ///< meaning of the response; {} stands for the range of ratings
        /// Usual questions about similarity, uniformity and other attributes; empty if there is none.
        std::array<std::string_view, 3> questions = {};
        std::vector<std::string_view> keys = {};    ///< keys of [[run]] that only some tasks have
        std::vector<std::string_view> columns = {}; ///< columns that only some tasks have
        std::vector<std::string_view> sections = {
            "has_cells"};               ///< sections of methods.md that each run needs
        bool has_silences = false;      ///< true if one of a trial's two stimuli is silence
        bool has_three_stimuli = false; ///< true if a trial has three stimuli
        bool moves_value = false;       ///< true if participants move the value; see find_next_move()
    };

    virtual ~task() = default;
    task(const task&) = delete;
    task& operator=(const task&) = delete;

    std::string_view name() const noexcept { return facts_.name; }
    const facts& properties() const noexcept { return facts_; }

    /// Reads the parts of a [[run]] that the analysis needs. `r` must already have motions, methods, labels
    /// and choices.
    /// \throws error (bad_input) with line and column, as check() and read() do.
    virtual void read_outline(const detail::toml_table& t, run_definition& r) const;
    /// Throws error (bad_input) if a run, or the part of a run for a group, has too few motions or methods.
    /// `t`: table that the error names.
    virtual void check(const detail::toml_table& /*t*/, const run_outline&) const {}
    /// Reads the parts of a [[run]] that only a session needs.
    virtual void read(const detail::toml_table&, run_definition&) const {}
    /// Returns the default words for the two answers; by default, no words.
    virtual std::vector<std::string> default_choices(const page_words&) const { return {}; }
    /// Returns the range of ratings for --dry-run, if any.
    virtual std::optional<rating_scale> scale(const run_outline&) const { return {}; }

    /// Lists the cells of a run: trials that differ in their stimuli, or in the order of their stimuli.
    virtual std::vector<planned_trial> list_cells(const run_definition& r) const = 0;
    /// Draws n trials in no particular order: each cell equally often as far as n allows.
    virtual std::vector<planned_trial> draw(const run_definition& r, std::size_t n,
                                            random_numbers& numbers) const;
    /// Draws the initial value of a trial. By default, does not change the trial.
    virtual void draw_initial_value(planned_trial&, const run_definition&, random_numbers&) const {}
    virtual std::unique_ptr<value_chooser> make_value_chooser(const run_definition& r) const;
    /// Returns true if the tables of a run have the task's own columns.
    virtual bool has_own_columns(const run_outline&) const { return true; }

    /// Returns the possible answers; by default, two answers.
    virtual trial_answers list_answers(const run_definition& r, const page_words& w) const;
    /// Returns a text that the participant sees above the question of a trial; by default, an empty text.
    virtual std::string announcement(const run_definition&, const planned_trial&, const page_words&) const
    {
        return {};
    }
    /// Returns the trial to play after an answer that does not end the trial. The returned trial may have
    /// another value. Returns nothing if the answer ends the trial, which is the default.
    virtual std::optional<planned_trial> find_next_move(const run_definition&, const planned_trial&,
                                                        const trial_answer&) const
    {
        return {};
    }
    /// Lists the trials that a simulated observer plays after the first trial until it reaches the answer; by
    /// default, no trials.
    virtual std::vector<planned_trial> list_moves(const run_definition&, const planned_trial&,
                                                  const trial_answer&) const
    {
        return {};
    }
    /// Returns the target of a motion as in the run's table. Returns an empty text if the table has no
    /// targets.
    virtual std::string format_target(const motion_definition&) const { return {}; }
    /// Sets the cells of an answer. `row`: row of the trial, with the value that was last played.
    virtual void record_answer(trial_row& row, const run_definition& r, const trial_answer& answer) const;
    /// Returns true if an answer is right. Returns nothing if answers are neither right nor wrong.
    virtual std::optional<bool> was_right(const experiment_definition&, const run_definition&,
                                          const planned_trial&, const trial_answer&) const
    {
        return {};
    }
    /// Lists the responses, as in tables, that have separate numbers in [sync.codes]. Returns an empty list
    /// if all responses share a number.
    virtual std::vector<std::string> list_responses(const run_outline& o) const;
    /// Returns the words for a response in the description of its code. Returns an empty text if all
    /// responses share a number.
    virtual std::string name_response(const run_outline& o, std::string_view response) const;

    /// Reads methods and answer of a trial from its row. \throws error (bad_input) with file and line.
    virtual void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const = 0;
    /// Sets the members of a trial that depend on the answer. `method_1`: name of the first stimulus's method
    /// in the table.
    virtual void score(trial& r, const run_outline& o, std::string_view method_1,
                       const trial_answer& answer) const;

    /// Prepares a simulated observer. \throws error (bad_input) if the observer cannot judge the run.
    virtual void prepare(simulated_run&) const {}
    /// Returns an observer's answer to a trial: 1 or 2, a rating, the number of a motion in the run (from 1),
    /// an estimate, or a drawing.
    virtual trial_answer simulate(const simulated_run& who, const planned_trial& t,
                                  random_numbers& r) const = 0;

    // Results.

    /// Returns the cells of a run in which each trial has a value. Returns nothing if the run measures
    /// figures, which is the default.
    virtual std::optional<cell_plan> plan_cells(const run_outline&) const { return {}; }
    /// Lists a participant's values in a run: a value for each cell, or the figures, beginning with the main
    /// figure. Lists only the names if there are no trials.
    virtual std::vector<named_value> measure(const run_outline& o, const std::vector<trial>& trials,
                                             sigmoid kind) const;
    /// Returns the figure that is compared between the two intervals of a trial; by default, nothing.
    virtual std::optional<interval_plan> plan_intervals(const run_outline&, sigmoid) const { return {}; }
    /// Returns the task's own rows of a run's results. They follow the rows that all runs have. `people`:
    /// participants with a trial in each cell.
    virtual std::vector<result> analyse(const run_outline& o, const run_people& people,
                                        sigmoid kind) const = 0;
    /// Lists the rows that analyse() may return, separately for each form that a run's results may have.
    virtual std::vector<std::vector<result_outline>> outline_results() const = 0;
    /// Lists the methods for which response times are summarised. Returns an empty list if each trial has
    /// several methods.
    virtual std::vector<std::string> list_timed_methods(const run_outline& o) const { return o.methods; }
    /// Returns true if a trial has one method, so that methods can be compared.
    virtual bool has_one_method(const run_outline&) const { return true; }
    /// Returns true if a trial has no stimulus.
    virtual bool is_silent(const trial&) const { return false; }

    virtual main_comparison name_comparison(const run_outline& o) const = 0;
    /// Returns a participant's value for the main comparison: usually the main figure, or the mean of the
    /// last method's cells.
    virtual compared_person compare(const run_outline& o, const std::vector<trial>& trials) const;
    /// Tests the main comparison, usually with a t test. `seed` determines random draws.
    virtual compared test(const run_outline& o, std::span<const compared_person> people,
                          std::string_view seed) const;

    /// Lists the columns of --format tsv that only studies with this task have.
    virtual std::vector<std::string_view> list_columns(const run_outline& o) const;
    /// Returns this task's cells of a trial in --format tsv: column and text. `own`: the part of the run for
    /// the participant's group. `whole`: the run with all groups.
    virtual named_texts describe_trial(const trial& t, const run_outline& own,
                                       const run_outline& whole) const;
    /// Returns the model of a run for R.
    virtual std::string format_r_model(const run_outline& o, const model_factors& f) const = 0;

    /// Describes a trial in the methods section.
    virtual std::string describe(const run_outline& o) const;
    /// Lists the sections of methods.md that a run needs.
    virtual std::vector<std::string_view> list_sections(const run_outline&) const { return facts_.sections; }
    /// Describes how answers determine the values; by default, returns an empty text for a run that is not
    /// adaptive. Adds the sections of methods.md that the description needs.
    virtual std::string describe_procedure(const run_definition& r,
                                           std::set<std::string_view>& sections) const;

protected:
    explicit task(facts f) : facts_(std::move(f)) {}

private:
    facts facts_;
};

/// Returns all tasks.
std::span<const task* const> list_tasks() noexcept;
/// Lists the names of all tasks.
std::vector<std::string_view> task_names();

/// Returns the task with a name. \pre there is such a task.
const task& find_task(std::string_view name) noexcept;

/// Returns the task of a run.
inline const task& find_run_task(const run_outline& o) noexcept
{
    return *o.task;
}

/// Returns the range of a run's ratings in words: "1 to 5", "0 to 100 on a visual analogue scale".
std::string rating_range(const run_outline& run);

/// Returns the comparison of a figure with the value `against`, if any.
main_comparison make_comparison(std::string_view figure, std::string_view test,
                                std::optional<double> against);

/// Reads `task` of a [[run]]. \throws error (bad_input) with line and column.
const task& read_task(const detail::toml_table& t);

/// Returns a text that lists answers for a terminal, such as "1 (not at all) to 5 (exactly)". With `named`,
/// labels have no brackets. With `each`, lists all answers: "1 yes, 2 no". Otherwise lists only the first and
/// the last answer, with the word `between`. `lowest`: number of the first answer.
std::string describe_answers(const std::vector<std::string>& labels, unsigned lowest, bool named, bool each,
                             std::string_view between);

} // namespace tactor::study
