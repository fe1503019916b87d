// SPDX-License-Identifier: MIT
#include "study/analysis/measures.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

namespace tactor::study {
namespace {

std::vector<answer_block> make_blocks(const std::vector<trial>& trials)
{
    std::map<double, answer_block> all;
    for (const trial& t : trials)
        if (t.signal) {
            answer_block& b = all.try_emplace(t.value, answer_block{t.value, 0, 0}).first->second;
            ++b.n;
            b.k += t.positive ? 1 : 0;
        }
    std::vector<answer_block> blocks;
    for (const auto& [x, b] : all)
        blocks.push_back(b);
    return blocks;
}

std::optional<double> estimate_exponent(const run_outline& run, const std::vector<trial>& trials)
{
    std::vector<double> ratios;
    std::vector<double> numbers;
    for (const trial& t : trials) {
        ratios.push_back(size_ratio(run, t.value, run.values.back()));
        numbers.push_back(t.estimate);
    }
    return stevens_exponent(ratios, numbers);
}

std::vector<value_estimate> normalise_estimates(const std::vector<trial>& trials)
{
    std::map<double, std::vector<double>> logs;
    for (const trial& t : trials)
        logs[t.value].push_back(std::log(t.estimate));
    double all = 0.0;
    for (const auto& [value, own] : logs)
        all += mean(own) / static_cast<double>(logs.size());
    std::vector<value_estimate> estimates;
    for (const auto& [value, own] : logs)
        estimates.push_back({value, std::exp(mean(own) - all), own.size()});
    return estimates;
}

// Measures the trials for which `counts` is true.
template <class Counts>
measured_condition measure_condition(const run_outline& run, const std::string& name,
                                     const std::vector<person_trials>& people, sigmoid kind,
                                     const Counts& counts)
{
    measured_condition c{name};
    std::map<std::string_view, std::vector<double>> values;
    for (const person_trials& p : people) {
        std::vector<trial> own;
        std::ranges::copy_if(*p.trials, std::back_inserter(own), counts);
        c.people.push_back(measure_trials(run, own, kind, fmt::format("{}/{}/{}", run.name, name, p.code)));
        for (const auto& [figure, value] : list_measures(run, c.people.back()))
            if (value)
                values[figure].push_back(*value);
    }
    const std::vector<named_measure> figures = list_measures(run, {});
    for (const auto& [figure, none] : figures) {
        const bool is_main = figure == figures.front().first;
        c.figures.emplace_back(
            figure, test_mean(values[figure], is_main ? measured_against(run).value_or(0.0) : 0.0));
    }
    if (run.task == task_kind::same_different) {
        std::vector<difference_counts> answers;
        for (const person_measures& m : c.people)
            if (m.detected)
                answers.push_back(m.detected->counts);
        c.difference = test_difference(answers, fmt::format("{}/{}", run.name, name));
        t_test& dprime = c.figures.front().second;
        dprime = {.n = dprime.n, .mean = dprime.mean, .se = dprime.se, .ci = dprime.ci};
    }
    return c;
}

} // namespace

psychometric_family find_family(const run_outline& run, sigmoid kind, double guess) noexcept
{
    return run.task == task_kind::detect ? psychometric_family{kind, guess} : two_answers(kind);
}

person_measures measure_trials(const run_outline& run, const std::vector<trial>& trials, sigmoid kind,
                               std::string_view seed)
{
    constexpr double most_guess = 0.9; // more leaves no room for a function
    person_measures m;
    if (run.task == task_kind::estimate) {
        m.exponent = estimate_exponent(run, trials);
        if (m.exponent)
            m.estimates = normalise_estimates(trials);
        return m;
    }
    const auto count = [&](bool signal, bool positive) {
        return static_cast<std::size_t>(std::ranges::count_if(
            trials, [&](const trial& t) { return t.signal == signal && (t.positive || !positive); }));
    };
    const difference_counts all{count(true, true), count(true, false), count(false, true),
                                count(false, false)};
    const std::size_t others = all.same;
    if (all.different > 0 && others > 0) {
        detection d{
            corrected_rate(all.hits, all.different), corrected_rate(all.false_alarms, others), {}, all};
        d.found = run.task == task_kind::detect ? yes_no(d.hits, d.false_alarms)
                                                : same_different(d.hits, d.false_alarms);
        m.detected = d;
    }
    if (run.vary.empty())
        return m;
    m.blocks = make_blocks(trials);
    if (others > 0)
        m.guess = std::min(most_guess, static_cast<double>(all.false_alarms) / static_cast<double>(others));
    const psychometric_family family = find_family(run, kind, m.guess);
    m.fit = fit_psychometric(m.blocks, family);
    if (m.fit && !seed.empty())
        m.bootstrap = bootstrap_psychometric(m.blocks, family, *m.fit, seed);
    if (!m.fit || run.task == task_kind::detect)
        return m;
    m.pse = m.fit->parameters.threshold;
    const double quartile = find_quartile(kind);
    if (!m.fit->step)
        m.jnd = m.fit->parameters.slope * quartile;
    if (const auto& slope = m.bootstrap.slope)
        m.jnd_ci = interval{slope->first * quartile, slope->second * quartile};
    return m;
}

std::vector<named_measure> list_measures(const run_outline& run, const person_measures& m)
{
    std::vector<named_measure> all;
    if (run.task == task_kind::estimate)
        all.emplace_back("exponent", m.exponent);
    else if (run.task == task_kind::constant || run.task == task_kind::adaptive)
        all = {{"pse", m.pse}, {"jnd", m.jnd}};
    else if (!run.vary.empty())
        all.emplace_back("threshold", m.fit ? std::optional(m.fit->parameters.threshold) : std::nullopt);
    if (run.task == task_kind::same_different || run.catches) {
        all.emplace_back("dprime", m.detected ? std::optional(m.detected->found.dprime) : std::nullopt);
        all.emplace_back("c", m.detected ? std::optional(m.detected->found.c) : std::nullopt);
    }
    return all;
}

std::optional<double> measured_against(const run_outline& run) noexcept
{
    if (run.task == task_kind::estimate)
        return 1.0;
    if (run.task == task_kind::same_different || (run.catches && run.vary.empty()))
        return 0.0;
    return run.standard;
}

double size_ratio(const run_outline& run, double value, double to) noexcept
{
    constexpr double db_per_tenfold = 20.0;
    return run.on_db_axis ? std::pow(10.0, (value - to) / db_per_tenfold) : value / to;
}

std::vector<measured_condition> measure_run(const run_outline& run, const std::vector<person_trials>& people,
                                            sigmoid kind)
{
    const auto measure = [&](const std::string& name, const auto& counts) {
        return measure_condition(run, name, people, kind, counts);
    };
    std::vector<measured_condition> all{measure("", [](const trial&) { return true; })};
    const bool has_method = run.task != task_kind::same_different;
    const std::size_t methods = has_method ? run.methods.size() : 1;
    if (methods * run.motions.size() < 2)
        return all;
    for (std::size_t method = 0; method < methods; ++method)
        for (std::size_t motion = 0; motion < run.motions.size(); ++motion)
            all.push_back(measure(
                (has_method ? run.methods[method] + ":" : "") + run.motions[motion], [&](const trial& t) {
                    return t.motion == motion &&
                           (!has_method || t.method_1 == method || (run.catches && !t.signal));
                }));
    return all;
}

} // namespace tactor::study
