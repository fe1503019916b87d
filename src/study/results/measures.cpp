// SPDX-License-Identifier: MIT
#include "study/results/measures.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/results/cells.hpp"

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

// Counts positive answers with and without a signal.
difference_counts count_positive_answers(const std::vector<trial>& trials)
{
    const auto count = [&](bool signal, bool positive) {
        return static_cast<std::size_t>(std::ranges::count_if(
            trials, [&](const trial& t) { return t.signal == signal && (t.positive || !positive); }));
    };
    return {count(true, true), count(true, false), count(false, true), count(false, false)};
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

} // namespace

fitted_function fit_answers(const std::vector<trial>& trials, psychometric_family family,
                            std::string_view seed)
{
    fitted_function f{.guess = family.guess};
    f.blocks = make_blocks(trials);
    if (const difference_counts n = count_positive_answers(trials); n.same > 0)
        f.guess = std::min(most_guess, static_cast<double>(n.false_alarms) / static_cast<double>(n.same));
    family.guess = f.guess;
    f.fit = fit_psychometric(f.blocks, family);
    if (f.fit && !seed.empty())
        f.bootstrap = bootstrap_psychometric(f.blocks, family, *f.fit, seed);
    return f;
}

fitted_function fit_comparisons(const std::vector<trial>& trials, sigmoid kind, std::string_view seed)
{
    fitted_function f = fit_answers(trials, two_answer_family(kind), seed);
    if (!f.fit)
        return f;
    f.pse = f.fit->parameters.threshold;
    const double quartile = find_quartile(kind);
    if (!f.fit->step)
        f.jnd = f.fit->parameters.slope * quartile;
    if (const auto& slope = f.bootstrap.slope)
        f.jnd_ci = interval{slope->first * quartile, slope->second * quartile};
    return f;
}

std::optional<detection> measure_detection(const std::vector<trial>& trials,
                                           sensitivity (*model)(double hits, double false_alarms))
{
    const difference_counts n = count_positive_answers(trials);
    if (n.different == 0 || n.same == 0)
        return {};
    const double hits = corrected_rate(n.hits, n.different);
    const double false_alarms = corrected_rate(n.false_alarms, n.same);
    return detection{hits, false_alarms, model(hits, false_alarms), n};
}

std::optional<odd_answers> measure_oddity(const std::vector<trial>& trials)
{
    if (trials.empty())
        return {};
    const right_count n{static_cast<std::size_t>(std::ranges::count_if(trials, &trial::positive)),
                        trials.size()};
    return odd_answers{n, triangle_dprime(corrected_right_share(n))};
}

fitted_exponent fit_exponent(const run_outline& run, const std::vector<trial>& trials)
{
    std::vector<double> ratios;
    std::vector<double> numbers;
    for (const trial& t : trials) {
        ratios.push_back(size_ratio(run, t.value, run.values.back()));
        numbers.push_back(t.estimate);
    }
    fitted_exponent e{stevens_exponent(ratios, numbers)};
    if (e.exponent)
        e.estimates = normalise_estimates(trials);
    return e;
}

adjustment average_adjustments(const run_outline& run, const std::vector<trial>& trials)
{
    std::vector<double> values;
    for (const trial& t : trials)
        values.push_back(t.value);
    if (values.empty())
        return {};
    adjustment a{.pse = mean(values)};
    a.constant_error = *a.pse - run.standard.value();
    if (values.size() > 1)
        a.sd = deviation(values, *a.pse);
    return a;
}

std::vector<named_value> compare_intervals(const interval_plan& p, const std::vector<trial>& trials)
{
    std::vector<trial> first;
    std::vector<trial> second;
    std::ranges::partition_copy(trials, std::back_inserter(first), std::back_inserter(second), p.is_first);
    const std::optional<double> a = p.measure(first);
    const std::optional<double> b = p.measure(second);
    return {
        {{"difference"}, a && b ? std::optional(*b - *a) : std::nullopt}, {{"first"}, a}, {{"second"}, b}};
}

std::optional<result> analyse_intervals(const interval_plan& p, const run_outline& run,
                                        const run_people& people)
{
    const auto compare = [&p](const std::vector<trial>& trials, const std::string&) {
        return compare_intervals(p, trials);
    };
    interval_effects v = measure_people(
        interval_effects{{}, p.figure}, split_conditions(run, people, {}).front(), people, 0.0, compare,
        [&p](const std::vector<named_value>& own) { return own.empty() ? compare_intervals(p, {}) : own; });
    if (v.figures.front().test.n == 0)
        return {};
    return result{{"time_order"}, p.heading, std::move(v)};
}

double size_ratio(const run_outline& run, double value, double to) noexcept
{
    constexpr double db_per_tenfold = 20.0;
    return run.on_db_axis ? std::pow(10.0, (value - to) / db_per_tenfold) : value / to;
}

std::vector<condition_trials> split_conditions(const run_outline& run, const run_people& people,
                                               const std::vector<std::string>& methods,
                                               const std::vector<double>& values)
{
    std::vector<condition_trials> all;
    const auto add = [&](const std::string& name, const auto& counts) {
        condition_trials& c = all.emplace_back(condition_trials{name});
        for (const person_trials& p : people.all)
            std::ranges::copy_if(*p.trials, std::back_inserter(c.people.emplace_back()), counts);
    };
    add("", [](const trial&) { return true; });
    const std::size_t rows = std::max<std::size_t>(methods.size(), 1);
    const std::size_t parts = std::max<std::size_t>(values.size(), 1);
    if (rows * run.motions.size() * parts < 2)
        return all;
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t motion = 0; motion < run.motions.size(); ++motion)
            for (std::size_t part = 0; part < parts; ++part) {
                const std::string name = (methods.empty() ? "" : methods[row] + ":") + run.motions[motion] +
                                         (values.empty() ? "" : ":" + plain_number(values[part]));
                add(name, [&](const trial& t) {
                    return t.motion == motion && (methods.empty() || t.method_1 == row || !t.signal) &&
                           (values.empty() || t.value == values[part]);
                });
            }
    return all;
}

std::vector<result> begin_figure_results(const run_outline& run, std::optional<double> against)
{
    std::vector<result> rows{{{"vary"}}, {{"against"}}};
    if (!run.vary.empty())
        rows[0].value = run.vary;
    if (against)
        rows[1].value = *against;
    return rows;
}

result make_row(const condition_trials& c, std::string_view name, std::string_view heading,
                result_value value)
{
    if (c.name.empty())
        return {{std::string(name)}, std::string(heading), std::move(value)};
    return {{"by", c.name, std::string(name)}, fmt::format("{}, {}", heading, c.name), std::move(value)};
}

std::string make_seed(const run_outline& run, const condition_trials& c, std::string_view code)
{
    return fmt::format("{}/{}/{}", run.name, c.name, code);
}

std::vector<named_value> list_pse(const fitted_function& f)
{
    return {{{"pse"}, f.pse}, {{"jnd"}, f.jnd}};
}

std::vector<named_value> list_threshold(const fitted_function& f)
{
    return {{{"threshold"}, f.fit ? std::optional(f.fit->parameters.threshold) : std::nullopt}};
}

std::vector<named_value> list_sensitivity(const std::optional<detection>& d)
{
    return {{{"dprime"}, d ? std::optional(d->found.dprime) : std::nullopt},
            {{"c"}, d ? std::optional(d->found.c) : std::nullopt}};
}

std::vector<named_value> list_oddity(const std::optional<odd_answers>& o)
{
    constexpr double per_cent = 100.0;
    std::optional<double> correct;
    if (o)
        correct = per_cent * static_cast<double>(o->counts.right) / static_cast<double>(o->counts.trials);
    return {{{"dprime"}, o ? std::optional(o->dprime) : std::nullopt}, {{"correct"}, correct}};
}

std::vector<named_value> list_exponent(const fitted_exponent& e)
{
    return {{{"exponent"}, e.exponent}};
}

std::vector<named_value> list_adjustment(const adjustment& a)
{
    return {{{"constant_error"}, a.constant_error}, {{"pse"}, a.pse}, {{"sd"}, a.sd}};
}

std::vector<result> analyse_comparisons(const run_outline& run, const run_people& people, sigmoid kind)
{
    const psychometric_functions begun{
        {},
        two_answer_family(kind),
        run.on_db_axis,
        run.standard ? "comparison chosen (%)"
                     : fmt::format("answered \"{}\" (%)", run.choices.size() == 2 ? run.choices[1] : "")};
    const auto measure = [&](const condition_trials& c) {
        const auto fit = [&](const std::vector<trial>& trials, const std::string& code) {
            return fit_comparisons(trials, kind, make_seed(run, c, code));
        };
        return measure_people(begun, c, people, run.standard, fit, list_pse);
    };
    return analyse_conditions(run, people, run.methods, run.standard, "psychometric",
                              "Psychometric functions over " + run.vary, measure);
}

} // namespace tactor::study
