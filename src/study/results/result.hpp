// SPDX-License-Identifier: MIT
/// \file
/// The results of a study: a list of rows for each run, in the order of tactor-analysis/1. Text, picture,
/// JSON and report loop over the rows by the type of their values, and know no task.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "study/data/dataset.hpp"
#include "study/statistics/bradley_terry.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/statistics/signal_detection.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {

/// A participant's trials that count.
struct person_trials {
    std::string code;
    const std::vector<trial>* trials = nullptr;
    std::string group = {};
};

/// Participants of a run, whose groups may be compared.
struct run_people {
    std::vector<person_trials> all = {};
    bool compares_groups = false;
};

/// A value of a participant, such as of the cell {METHOD, MOTION}, or the figure {"pse"}.
struct named_value {
    std::vector<std::string> name;
    std::optional<double> value = {};
};

/// Mean over participants of a motion, or of all.
struct cell_mean {
    std::string name;
    t_test test = {};
    std::vector<double> values = {}; ///< of each participant
    std::optional<double> p_holm = {};
};

/// Means of a method: "all", about the participants' unweighted means over motions, then each motion.
struct cell_means {
    std::string method = {};            ///< empty: the run has no other row
    std::string axis = {};              ///< title of an axis: "correct (%)"
    std::optional<double> against = {}; ///< what guessing gives; none: not tested
    interval possible = {};             ///< values that a mean may have
    std::size_t rows = 1;               ///< of the run
    std::vector<cell_mean> means = {};
};

/// Per cent of trials in which the first interval was chosen.
struct interval_share {
    t_test test;
};

/// The last method's mean over all motions less the first's.
struct method_difference {
    std::string last;
    std::string first;
    t_test test;
};

/// Effects by name, as "group:motion"; none of a factor with one level.
struct effect_list {
    std::vector<std::pair<std::string, std::optional<effect>>> effects = {};
    bool of_groups = false;
};

/// Tukey's comparisons of motions.
struct tukey_list {
    std::string method = {}; ///< empty: the run has no other list
    std::vector<std::string> motions = {};
    std::vector<comparison> pairs = {};
};

/// Motions compared by paired t tests.
struct paired_list {
    std::string method;
    std::vector<std::string> motions = {};
    std::vector<paired_comparison> pairs = {};
};

/// Worths from the trials of all participants.
struct worth_list {
    std::vector<std::string> methods = {};
    std::vector<worth> worths = {};
};

/// Answers of all participants by motion and motion answered.
struct answer_counts {
    std::string method;
    std::vector<std::string> motions = {};
    std::vector<std::vector<std::size_t>> counts = {};
};

/// Mean over participants of a figure that each has.
struct measured_figure {
    std::string name;
    t_test test = {};
    std::optional<double> against = {}; ///< none: not tested
};

/// A participant's psychometric function.
struct fitted_function {
    std::vector<answer_block> blocks = {}; ///< answers by value, ascending
    double guess = 0.0;                    ///< share of trials without a stimulus with a positive answer
    std::optional<psychometric_fit> fit = {};
    psychometric_bootstrap bootstrap = {};
    std::optional<double> pse = {}; ///< of answers that compare: the threshold of the fit
    std::optional<double> jnd = {}; ///< the same; none where the answers rise in one step
    std::optional<interval> jnd_ci = {};
};

/// Sensitivity with the rates that it is from, corrected: corrected_rate().
struct detection {
    double hits = 0.0;
    double false_alarms = 0.0;
    sensitivity found = {};
    difference_counts counts = {}; ///< of the answers; detect: to a stimulus and to none
};

/// Estimates of one value.
struct value_estimate {
    double value = 0.0;
    double ratio = 1.0; ///< of the geometric mean of its estimates to that of all values
    std::size_t n = 0;  ///< estimates
};

struct fitted_exponent {
    std::optional<double> exponent = {};
    std::vector<value_estimate> estimates = {}; ///< by value, ascending; empty without an exponent
};

/// Participants in one condition, METHOD:MOTION, or in all trials, where its name is empty. The main figure
/// is the first.
template <class Person>
struct measured {
    std::string condition = {};
    std::vector<std::string> codes = {};
    std::vector<Person> people = {}; ///< by code
    std::vector<measured_figure> figures = {};
    std::vector<std::vector<std::optional<double>>> values = {}; ///< of the figures, by participant
};

struct psychometric_functions : measured<fitted_function> {
    psychometric_family family = {}; ///< without a guess
    bool on_db_axis = false;         ///< the values are levels in dB
    std::string axis = {};           ///< of the answers: "felt (%)"
};

struct sensitivities : measured<std::optional<detection>> {
    std::optional<difference_test> ratio = {}; ///< in place of t and p
};

struct exponents : measured<fitted_exponent> {};

using result_value = std::variant<std::monostate, std::string, double, cell_means, interval_share,
                                  method_difference, effect_list, tukey_list, paired_list, worth_list,
                                  answer_counts, psychometric_functions, sensitivities, exponents>;

/// A row of a run's results.
struct result {
    std::vector<std::string> at; ///< place in the run's JSON, as {"correct", METHOD}
    std::string heading = {};    ///< of its table; empty: it has none
    result_value value = {};     ///< monostate: null
    bool is_main = false;        ///< it begins with the run's main figure
};

/// Response times: the median of the participants' medians, each of the times that were recorded. Nothing
/// where there is none.
struct response_times {
    std::optional<double> median_s = {}; ///< of all trials
    /// The same for each condition: MOTION, or METHOD:MOTION where a trial has one stimulus.
    std::vector<std::pair<std::string, std::optional<double>>> by = {};
};

struct run_analysis {
    run_outline run;
    std::size_t n = 0;                  ///< participants with a trial that counts in each cell
    std::vector<left_out> missing = {}; ///< have trials that are not in the figures
    std::size_t trials = 0;             ///< that count, of the n
    std::size_t voids = 0;              ///< of everybody who was selected
    std::size_t early = 0;              ///< answers marked early, of the same; they count
    response_times times = {};          ///< of the n
    /// Group of the participants, whose name is in that of `run`, too. Empty: those whose group has all of
    /// it.
    std::string group = {};
    std::string whole = {}; ///< name of the run without the group
    std::vector<result> results = {};
};

struct analysis {
    std::string experiment; ///< its name
    std::size_t participants = 0;
    bool simulated = false;
    std::vector<left_out> excluded = {}; ///< by whoever asked for the analysis
    /// Results of everybody, then of each group those of the runs that it has.
    std::vector<run_analysis> runs = {};
    std::vector<std::string> warnings = {};   ///< about files and participants
    std::vector<std::string> no_figures = {}; ///< why figures are missing
};

/// Lists the values of a type among results, in order.
template <class T>
std::vector<const T*> list_values(const std::vector<result>& results)
{
    std::vector<const T*> all;
    for (const result& r : results)
        if (const T* v = std::get_if<T>(&r.value))
            all.push_back(v);
    return all;
}

/// Returns the row with the run's main figure; null if it has none.
const result* find_main(const std::vector<result>& results) noexcept;

/// Tests whether a value has figures to show in a table.
bool has_table(const result_value& v);

/// Says why figures of a run are missing, each as "RUN: FIGURE: WHY".
std::vector<std::string> explain_missing(const run_analysis& r);

/// Limits of a mean of per cents.
inline constexpr interval per_cents{0.0, 100.0};

/// Cuts an interval from t, which knows no bounds of the values, to what is possible.
interval cut_to(const interval& i, const interval& possible);

} // namespace tactor::study
