// SPDX-License-Identifier: MIT
/// \file
/// The results of a study: a list of rows for each run, in the order of tactor-analysis/1. The code for text,
/// picture, JSON and report depends only on the types of the values in the rows, not on tasks.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "study/data/trial.hpp"
#include "study/statistics/bradley_terry.hpp"
#include "study/statistics/pairs.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/statistics/scaling.hpp"
#include "study/statistics/signal_detection.hpp"

namespace tactor::study {

/// A participant's trials that count.
struct person_trials {
    std::string code;
    const std::vector<trial>* trials = nullptr;
    std::string group = {};
    const std::vector<predicted_path>* predictions = nullptr; ///< may be null
};

/// Participants of a run.
struct run_people {
    std::vector<person_trials> all = {};
    bool compares_groups = false;
};

/// A participant's value, for example of the cell {METHOD, MOTION} or the figure {"pse"}.
struct named_value {
    std::vector<std::string> name;
    std::optional<double> value = {};
    bool is_angle = false; ///< true for an angle in degrees
};

/// Mean over participants for one motion or for all motions.
struct cell_mean {
    std::string name;
    t_test test = {};
    std::vector<double> values = {}; ///< value of each participant
    std::optional<double> p_holm = {};
};

/// Means of a method: first "all", from the participants' unweighted means over motions, then each motion.
struct cell_means {
    std::string method = {};            ///< empty if the means are of all methods together
    std::string axis = {};              ///< title of an axis, such as "correct (%)"
    std::optional<double> against = {}; ///< value expected from guessing; if missing, there is no test
    interval possible = {};             ///< possible range of a mean
    std::size_t rows = 1;               ///< number of rows in the run
    std::vector<cell_mean> means = {};
};

/// Per cent of trials in which the first interval was chosen.
struct interval_share {
    t_test test;
};

/// Mean over all motions of the last method minus the mean of the first method.
struct method_difference {
    std::string last;
    std::string first;
    t_test test;
};

/// Effects by name, such as "group:motion". The effect of a factor with one level is missing.
struct effect_list {
    std::vector<std::pair<std::string, std::optional<effect>>> effects = {};
    bool of_groups = false;
};

/// Motions compared by Tukey's test.
struct tukey_list {
    std::string method = {}; ///< empty if the run has only one list
    std::vector<std::string> motions = {};
    std::vector<comparison> pairs = {};
};

/// Motions compared by paired t tests.
struct paired_list {
    std::string method;
    std::vector<std::string> motions = {};
    std::vector<paired_comparison> pairs = {};
};

/// Means of a figure by level, of all participants or of a group.
struct level_means {
    std::string group = {};                       ///< empty for all participants
    t_test overall = {};                          ///< mean of the participants' means over levels; not tested
    std::vector<t_test> means = {};               ///< mean of each level; not tested
    std::vector<std::vector<double>> values = {}; ///< values by level and participant
};

/// A figure compared between the levels of a factor, within participants.
struct figure_comparison {
    std::string factor;                     ///< method or session
    std::string figure;                     ///< such as "jnd"
    std::vector<std::string> levels = {};   ///< names of the levels
    level_means all = {};                   ///< means of all participants
    std::vector<level_means> by_group = {}; ///< means of each group, if groups are compared
    /// Pairs of groups, by the participants' means over levels; the tests have d.
    std::vector<paired_comparison> group_pairs = {};
    std::vector<paired_comparison> pairs = {}; ///< pairs of levels; the tests have d_z
    std::optional<effect> anova = {};          ///< effect of the levels, if there are three or more
    /// Effects of the groups, of the factor and of the interaction; missing if groups are not compared.
    std::optional<effect_list> groups = {};
};

/// Returns the names of the compared groups, in alphabetical order.
std::vector<std::string> list_groups(const figure_comparison& c);

/// Worths of methods, estimated from the trials of all participants.
struct worth_list {
    std::vector<std::string> methods = {};
    std::vector<worth> worths = {};
};

/// Differences between methods, and the places of methods computed from the differences.
struct scaled_methods {
    std::vector<std::vector<double>> differences = {}; ///< difference between each pair of methods, 0 to 100
    scaled_items scaled = {};
};

/// Maps of the methods in a plane: a map by the mean differences of all participants, and a map for each
/// participant.
struct method_map {
    std::vector<std::string> methods = {};
    scaled_methods all = {};
    std::vector<std::string> codes = {};
    std::vector<scaled_methods> people = {}; ///< in the order of `codes`
};

/// Number of answers of all participants, by motion played and motion answered.
struct answer_counts {
    std::string method;
    std::vector<std::string> motions = {};
    std::vector<std::vector<std::size_t>> counts = {};
};

/// Mean of a figure over participants.
struct measured_figure {
    std::string name;
    t_test test = {};
    std::optional<double> against = {}; ///< value for the test; if missing, there is no test
};

/// Greatest guess rate of a fit: a greater guess rate leaves no room for a function.
inline constexpr double most_guess = 0.9;

/// A participant's psychometric function.
struct fitted_function {
    std::vector<answer_block> blocks = {}; ///< answers by value, ascending
    double guess = 0.0;                    ///< guess rate, see fit_answers()
    std::optional<psychometric_fit> fit = {};
    psychometric_bootstrap bootstrap = {};
    std::optional<double> pse = {}; ///< threshold of the fit (comparisons only)
    std::optional<double> jnd = {}; ///< comparisons only; missing if the answers rise in one step
    std::optional<interval> jnd_ci = {};
};

/// Sensitivity, and the corrected rates from which it is computed: see corrected_rate().
struct detection {
    double hits = 0.0;
    double false_alarms = 0.0;
    sensitivity found = {};
    difference_counts counts = {}; ///< counts of answers; in detect, with and without a stimulus
};

/// A participant's magnitude estimates of one value.
struct value_estimate {
    double value = 0.0;
    double ratio = 1.0; ///< geometric mean of the estimates, relative to the mean of all values
    std::size_t n = 0;  ///< number of estimates
};

struct fitted_exponent {
    std::optional<double> exponent = {};
    std::vector<value_estimate> estimates = {}; ///< by value, ascending; empty if there is no exponent
};

/// Results of participants in one condition, METHOD:MOTION, or in all trials if `condition` is empty. The
/// first figure is the main figure.
template <class Person>
struct measured {
    std::string condition = {};
    std::vector<std::string> codes = {};
    std::vector<Person> people = {}; ///< in the order of `codes`
    std::vector<measured_figure> figures = {};
    std::vector<std::vector<std::optional<double>>> values = {}; ///< values of the figures, by participant
};

struct psychometric_functions : measured<fitted_function> {
    psychometric_family family = {}; ///< its guess rate is not used
    bool on_db_axis = false;         ///< true if the values are levels in dB
    std::string axis = {};           ///< title of the axis of answers, such as "felt (%)"
};

struct sensitivities : measured<std::optional<detection>> {
    std::optional<difference_test> ratio = {}; ///< test that replaces t and p
};

/// Answers to three stimuli, and d' from the corrected share of right answers: see corrected_right_share().
struct odd_answers {
    right_count counts = {};
    double dprime = 0.0;
};

struct oddities : measured<std::optional<odd_answers>> {
    std::optional<difference_test> ratio = {}; ///< test that replaces t and p
};

struct exponents : measured<fitted_exponent> {};

/// A participant's adjustments of one value to a standard.
struct adjustment {
    std::optional<double> constant_error = {}; ///< pse minus the standard
    std::optional<double> pse = {};            ///< mean of the values that the participant accepted
    std::optional<double> sd = {};             ///< standard deviation of these values; missing with one trial
};

struct adjustments : measured<adjustment> {};

/// A figure of all trials, split by the interval that contained the standard or the stimulus. The figures are
/// "difference" (the time-order error: second interval minus first), "first" and "second".
struct interval_effects : measured<std::vector<named_value>> {
    std::string figure = {}; ///< "pse" or "right"
};

/// Number of equal parts into which drawn paths are divided for comparison.
inline constexpr std::size_t drawn_parts = 50;

/// A participant's drawings, each divided into drawn_parts, and the figures of the drawings.
struct drawn_by_person {
    std::vector<std::vector<point>> drawings = {};
    std::vector<named_value> figures = {};
};

/// Drawing that an observer is predicted to make, and its distances from the mean drawing.
struct predicted_drawing {
    std::string observer;
    std::vector<point> points = {}; ///< points that divide the drawing into drawn_parts
    double distance_mm = 0.0;       ///< mean distance between corresponding points
    double frechet_mm = 0.0;
};

/// Places or paths that participants drew.
struct drawn_answers : measured<drawn_by_person> {
    drawing_kind kind = drawing_kind::place;
    std::vector<point> target = {}; ///< divided into drawn_parts; empty if there are several motions
    std::vector<point> mean = {};   ///< mean of the participants' mean drawings; empty for several motions
    std::vector<predicted_drawing> predicted = {}; ///< if recorded, for one motion and one method
};

using result_value =
    std::variant<std::monostate, std::string, double, cell_means, interval_share, method_difference,
                 effect_list, tukey_list, paired_list, figure_comparison, worth_list, method_map,
                 answer_counts, psychometric_functions, sensitivities, oddities, exponents, adjustments,
                 interval_effects, drawn_answers>;

/// A row of a run's results.
struct result {
    std::vector<std::string> at; ///< place in the run's JSON, such as {"correct", METHOD}
    std::string heading = {};    ///< heading of the row's table; empty if there is none
    result_value value = {};     ///< monostate is null in JSON
    bool is_main = false;        ///< true if the value begins with the run's main figure
};

/// A row that a task may have, for the schema.
struct result_outline {
    std::vector<std::string> at; ///< as in result; "*" stands for any name in a study
    result_value value;          ///< value without figures
    bool or_null = false;
    bool optional = false; ///< true if some studies do not have the row
};

/// Returns an outline of cell means. `tested`: true if the means are tested.
cell_means outline_cells(bool tested);
/// Returns a value with one unnamed figure and no participants.
template <class Measured>
Measured outline_figures()
{
    Measured v;
    v.figures.emplace_back();
    return v;
}
/// Returns an outline of effects with these names.
effect_list outline_effects(const std::vector<std::string>& names);
/// Returns the rows of a run that measures figures. Each row of `named` occurs for all trials and for each
/// condition. `intervals`: true if the two intervals of a trial may be compared.
std::vector<result_outline> outline_figure_results(const std::vector<result_outline>& named,
                                                   bool intervals = false);
/// Returns the row that compares figures between methods or sessions. `factor`: "method" or "session".
result_outline outline_comparison(const std::string& factor);
/// Returns the row that compares groups. `methods`: true if the row has the effects of methods.
result_outline outline_groups(bool methods);

/// Response times: medians of the participants' medians. A median is missing if no time was recorded.
struct response_times {
    std::optional<double> median_s = {}; ///< median over all trials
    /// Medians by condition: MOTION, or METHOD:MOTION if a trial has one stimulus.
    std::vector<std::pair<std::string, std::optional<double>>> by = {};
};

/// A track of a participant.
struct person_track {
    std::string participant;
    played_track track;
};

struct run_analysis {
    run_outline run;
    std::size_t n = 0;                         ///< number of participants with a valid trial in each cell
    std::vector<excluded_person> missing = {}; ///< participants whose trials are not in the figures
    std::size_t trials = 0;                    ///< number of valid trials of these n participants
    std::size_t voids = 0;                     ///< number of void trials of all selected participants
    std::size_t dropped = 0;                   ///< number of trials of these participants that are left out
    std::size_t early = 0;     ///< number of early answers of all selected participants; they count
    response_times times = {}; ///< response times of the n participants
    std::vector<person_track> tracks = {}; ///< tracks of the n participants, if tracks may end early
    std::string track_rule = {};           ///< keys that may end tracks early; empty if there are none
    /// Group of the participants, which is also part of the name of `run`. Empty for the results of all
    /// participants whose group does the whole run.
    std::string group = {};
    std::string whole = {}; ///< name of the run without the group
    std::vector<result> results = {};
};

struct analysis {
    std::string experiment; ///< name of the experiment
    std::size_t participants = 0;
    bool simulated = false;
    std::vector<excluded_person> excluded = {}; ///< participants who are not selected
    std::string drop_rule = {};                 ///< description of the trials left out; empty if none
    /// Results of all participants by run, then the results of each group by run.
    std::vector<run_analysis> runs = {};
    std::vector<std::string> warnings = {};   ///< warnings about files and participants
    std::vector<std::string> no_figures = {}; ///< reasons for missing figures
};

/// Lists the values of type T in results, in order.
template <class T>
std::vector<const T*> list_values(const std::vector<result>& results)
{
    std::vector<const T*> all;
    for (const result& r : results)
        if (const T* v = std::get_if<T>(&r.value))
            all.push_back(v);
    return all;
}

/// Returns the row with the run's main figure, or null if there is none.
const result* find_main_result(const std::vector<result>& results) noexcept;

/// Returns true if a value has figures to show in a table.
bool has_table(const result_value& v);

/// Describes how the tracks of a run ended, and how many trials they had. The first text is about all tracks.
/// If there are several methods or procedures, a text for each follows. \pre There are tracks.
std::vector<std::string> describe_tracks(const run_analysis& r);

/// Reasons why figures of a run are missing, or may be wrong, each as "RUN: FIGURE: WHY".
struct explained_figures {
    std::vector<std::string> missing = {};
    std::vector<std::string> doubtful = {}; ///< each with a hint
};
explained_figures explain_figures(const run_analysis& r);

/// Range of a mean in per cent.
inline constexpr interval per_cents{0.0, 100.0};

/// Cuts a t interval, which may exceed the range of the values, to the possible range.
interval clamp_interval(const interval& i, const interval& possible);

} // namespace tactor::study
