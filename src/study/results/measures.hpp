// SPDX-License-Identifier: MIT
/// \file
/// Figures that a task measures from a participant's trials: a psychometric function, d', the exponent of
/// magnitude estimates, or the mean of adjustments.
#pragma once

#include <cstddef>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "study/results/cells.hpp"
#include "study/results/result.hpp"

namespace tactor::study {

/// Fits a psychometric function to answers. The guess rate is the share of positive answers in trials without
/// a stimulus, or if there are no such trials, the guess rate of `family`.
/// `seed` seeds the bootstrap; if it is empty, there is no bootstrap.
fitted_function fit_answers(const std::vector<trial>& trials, psychometric_family family,
                            std::string_view seed);

/// Fits the psychometric function of comparisons, and computes pse and jnd.
fitted_function fit_comparisons(const std::vector<trial>& trials, sigmoid kind, std::string_view seed);

/// Returns d', and the rates of positive answers in trials with and without a signal. Returns nothing unless
/// there are trials of both kinds. `model` computes d' from both rates.
std::optional<detection> measure_detection(const std::vector<trial>& trials,
                                           sensitivity (*model)(double hits, double false_alarms));

/// Counts the right answers to three stimuli, and computes d'. Returns nothing if there are no trials.
std::optional<odd_answers> measure_oddity(const std::vector<trial>& trials);

fitted_exponent fit_exponent(const run_outline& run, const std::vector<trial>& trials);

/// Returns the mean, the constant error and the standard deviation of the trials' values.
adjustment average_adjustments(const run_outline& run, const std::vector<trial>& trials);

/// A figure that may depend on which interval contained the standard or the stimulus.
struct interval_plan {
    std::string figure;             ///< see interval_effects
    std::string heading;            ///< heading of the row
    bool (*is_first)(const trial&); ///< true if the first interval contained the standard or the stimulus
    std::function<std::optional<double>(const std::vector<trial>&)> measure;
};

/// Returns "difference", "first" and "second", the figures of interval_effects.
std::vector<named_value> compare_intervals(const interval_plan& p, const std::vector<trial>& trials);

/// Returns the result row of a plan, or nothing if no participant has trials in both orders.
std::optional<result> analyse_intervals(const interval_plan& p, const run_outline& run,
                                        const run_people& people);

/// Returns the ratio of two values; for levels in dB, the ratio of their amplitudes.
double size_ratio(const run_outline& run, double value, double to) noexcept;

/// Trials of one condition, METHOD:MOTION, or all trials if the name is empty.
struct condition_trials {
    std::string name;
    std::vector<std::vector<trial>> people = {}; ///< trials by participant
};

/// Returns all trials, and then the trials of each condition, if there are several. A trial without a
/// stimulus belongs to all conditions of its motion. `methods`: the run's methods, if conditions depend on
/// the method. `values`: the run's values, if conditions also depend on the value; the name of a condition is
/// then METHOD:MOTION:VALUE.
std::vector<condition_trials> split_conditions(const run_outline& run, const run_people& people,
                                               const std::vector<std::string>& methods,
                                               const std::vector<double>& values = {});

/// Returns the first results of a task that measures figures. `against`: value that the main figure is tested
/// against, if any.
std::vector<result> begin_figure_results(const run_outline& run, std::optional<double> against);

/// Returns the row of a condition. `name`: name of this kind of row in JSON.
result make_row(const condition_trials& c, std::string_view name, std::string_view heading,
                result_value value);

/// Returns the seed of a participant's random numbers in a condition.
std::string make_seed(const run_outline& run, const condition_trials& c, std::string_view code);

/// List a participant's figures, the main figure first. In the order of the functions: pse and jnd; the
/// threshold; d' and c; d' and the per cent of right answers; the exponent; the constant error, pse and sd.
std::vector<named_value> list_pse(const fitted_function& f);
std::vector<named_value> list_threshold(const fitted_function& f);
std::vector<named_value> list_sensitivity(const std::optional<detection>& d);
std::vector<named_value> list_oddity(const std::optional<odd_answers>& o);
std::vector<named_value> list_exponent(const fitted_exponent& e);
std::vector<named_value> list_adjustment(const adjustment& a);

/// Measures each participant in a condition with `fit(trials, code)`, and tests the figures that `list`
/// returns. `against`: value against which the main figure is tested.
template <class Values, class Fit, class Figures>
Values measure_people(Values v, const condition_trials& c, const run_people& people,
                      std::optional<double> against, const Fit& fit, const Figures& list)
{
    v.condition = c.name;
    for (std::size_t i = 0; i < people.all.size(); ++i) {
        v.codes.push_back(people.all[i].code);
        v.people.push_back(fit(c.people[i], v.codes.back()));
        v.values.emplace_back();
        for (const named_value& figure : list(v.people.back()))
            v.values.back().push_back(figure.value);
    }
    const std::vector<named_value> names = list({});
    for (std::size_t k = 0; k < names.size(); ++k) {
        std::vector<double> there;
        for (const auto& own : v.values)
            if (own[k])
                there.push_back(*own[k]);
        if (names[k].is_angle)
            there = unwrap_angles(std::move(there));
        const std::optional<double> its = k == 0 ? against : std::nullopt;
        v.figures.push_back({names[k].name.front(), test_mean(there, its.value_or(0.0)), its});
    }
    return v;
}

/// Calls `get` for each element, and lists the values that `get` returns, without the missing ones.
template <class All, class Get>
auto list_present_values(const All& all, const Get& get)
{
    using found = std::remove_cvref_t<std::invoke_result_t<Get, decltype(*std::begin(all))>>;
    std::vector<typename found::value_type> there;
    for (const auto& one : all)
        if (auto value = get(one))
            there.push_back(*std::move(value));
    return there;
}

/// Measures d' of each participant with measure_people(). Tests d' = 0 with `test(counts, seed)` instead of
/// testing the mean of d'. `measure(trials)` returns d' and the counts of answers.
template <class Values, class Measure, class Figures, class Test>
Values measure_by_ratio(Values v, const run_outline& run, const condition_trials& c, const run_people& people,
                        const Measure& measure, const Figures& list, const Test& test)
{
    const auto fit = [&](const std::vector<trial>& trials, const std::string&) { return measure(trials); };
    v = measure_people(std::move(v), c, people, 0.0, fit, list);
    const auto counts = [](const auto& one) { return one ? std::optional(one->counts) : std::nullopt; };
    v.ratio = test(list_present_values(v.people, counts), run.name + '/' + c.name);
    v.figures.front().test = omit_test(v.figures.front().test);
    return v;
}

/// Returns the main figure of each participant.
template <class Person>
std::vector<std::optional<double>> list_main_figures(const measured<Person>& v)
{
    std::vector<std::optional<double>> all;
    for (const auto& own : v.values)
        all.push_back(own.front());
    return all;
}

/// Analyses all trials of a run, and then each condition. Each result of `make(condition)` becomes a row.
/// Compares groups by the main figure of all trials. `methods`, `values`: see split_conditions().
template <class Make>
std::vector<result> analyse_conditions(const run_outline& run, const run_people& people,
                                       const std::vector<std::string>& methods, std::optional<double> against,
                                       std::string_view name, std::string_view heading, const Make& make,
                                       const std::vector<double>& values = {})
{
    std::vector<result> rows = begin_figure_results(run, against);
    std::vector<std::optional<double>> main;
    for (const condition_trials& c : split_conditions(run, people, methods, values)) {
        auto v = make(c);
        if (c.name.empty())
            main = list_main_figures(v);
        rows.push_back(make_row(c, name, heading, std::move(v)));
        rows.back().is_main = c.name.empty();
    }
    add_groups(rows, people, main);
    return rows;
}

/// Analyses a run whose answers compare two stimuli or judge one stimulus with two words.
std::vector<result> analyse_comparisons(const run_outline& run, const run_people& people, sigmoid kind);

} // namespace tactor::study
