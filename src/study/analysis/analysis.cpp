// SPDX-License-Identifier: MIT
#include "study/analysis/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

// Tests all participants' values in one row of cells, by motion, and their means over motions.
by_motion test_row(const std::vector<cell_values>& all, std::size_t row, std::size_t motions, double against)
{
    by_motion b;
    std::vector<double> means;
    for (const cell_values& v : all)
        means.push_back(mean(v[row]));
    b.all = test_mean(means, against);
    b.all_values = means;
    std::vector<std::optional<double>> p;
    for (std::size_t m = 0; m < motions; ++m) {
        std::vector<double> one;
        for (const cell_values& v : all)
            one.push_back(v[row][m]);
        b.motion.push_back(test_mean(one, against));
        p.push_back(b.motion.back().p);
        b.motion_values.push_back(std::move(one));
    }
    b.p_holm = holm(p);
    return b;
}

cell_table lay_out_cells(const std::vector<cell_values>& all, std::size_t from_row, std::size_t rows,
                         std::size_t motions)
{
    cell_table t;
    t.first_levels = rows;
    t.second_levels = motions;
    for (const cell_values& v : all) {
        std::vector<double> line;
        for (std::size_t row = from_row; row < from_row + rows; ++row)
            line.insert(line.end(), v[row].begin(), v[row].end());
        t.values.push_back(std::move(line));
    }
    return t;
}

// Adds the intervals within participants: of all cells together, and of the rows' means.
void add_within_intervals(run_analysis& r, const std::vector<cell_values>& all)
{
    const std::size_t motions = r.run.motions.size();
    const auto cells =
        within_intervals(lay_out_cells(all, 0, r.cells.size(), motions).values, rounding_in(r.run));
    std::vector<std::vector<double>> means;
    for (const cell_values& v : all) {
        means.emplace_back();
        for (const std::vector<double>& row : v)
            means.back().push_back(mean(row));
    }
    const auto rows = within_intervals(means, rounding_in(r.run));
    for (std::size_t row = 0; row < rows.size(); ++row) {
        r.cells[row].all.ci_within = rows[row];
        for (std::size_t m = 0; m < motions; ++m)
            r.cells[row].motion[m].ci_within = cells[row * motions + m];
    }
}

std::vector<comparison> compare_motions(const by_motion& b, const effect& e)
{
    std::vector<double> means;
    for (const t_test& t : b.motion) {
        if (!t.mean)
            return {};
        means.push_back(*t.mean);
    }
    return tukey(means, b.all.n, e.ms_error, e.df2);
}

// Returns the number of rows of a run's cells: those of its last methods.
std::size_t count_rows(const run_outline& run)
{
    return run.task == task_kind::choose && !has_worths(run) ? 1 : run.methods.size();
}

void analyse_values(run_analysis& r, const std::vector<cell_values>& all)
{
    const std::size_t motions = r.run.motions.size();
    const std::size_t rows = count_rows(r.run);
    for (std::size_t row = 0; row < rows; ++row)
        r.cells.push_back(test_row(all, row, motions, chance(r.run)));
    add_within_intervals(r, all);
    if (r.run.task == task_kind::identify)
        for (const by_motion& b : r.cells)
            r.paired_motions.push_back(compare_pairs(b.motion_values, rounding_in(r.run)));
    // Rows of methods to choose from are not independent: what one gains another loses.
    if (r.run.task == task_kind::identify || has_worths(r.run))
        return;
    r.effects = repeated_measures(lay_out_cells(all, 0, rows, motions));
    for (std::size_t row = 0; row < rows; ++row)
        r.pairs.push_back(
            compare_motions(r.cells[row], repeated_measures(lay_out_cells(all, row, 1, motions)).second));
    if (r.run.task == task_kind::choose || rows < 2)
        return;
    std::vector<double> differences;
    for (const cell_values& v : all)
        differences.push_back(*compared_value(r.run, v));
    r.paired = test_mean(differences, 0.0, rounding_in(r.run));
}

// Compares the groups of participants by all their cells.
mixed_anova compare_groups(const std::vector<cell_values>& all, const std::vector<std::string>& groups)
{
    const std::set<std::string> names(groups.begin(), groups.end());
    if (names.size() < 2)
        return {};
    std::vector<std::size_t> numbers;
    for (const std::string& g : groups)
        numbers.push_back(static_cast<std::size_t>(std::distance(names.begin(), names.find(g))));
    return analyse_groups(lay_out_cells(all, 0, all[0].size(), all[0][0].size()), numbers);
}

void count_answers(run_analysis& r, const std::vector<person_trials>& people)
{
    const std::size_t motions = r.run.motions.size();
    r.confusion.assign(r.run.methods.size(),
                       std::vector<std::vector<std::size_t>>(motions, std::vector<std::size_t>(motions, 0)));
    for (const person_trials& p : people)
        for (const trial& t : *p.trials)
            ++r.confusion[t.method_1][t.motion][t.response];
}

std::vector<worth> estimate_worths(const run_outline& run, const std::vector<person_trials>& people)
{
    std::vector<std::vector<double>> wins(run.methods.size(), std::vector<double>(run.methods.size()));
    for (const person_trials& p : people)
        for (const trial& t : *p.trials)
            ++wins[chosen_method(t)][t.response == 1 ? t.method_2 : t.method_1];
    return bradley_terry(wins);
}

response_times summarise_times(const run_outline& run, const std::vector<person_trials>& people)
{
    const auto find_median = [&](const auto& counts) {
        std::vector<double> medians;
        for (const person_trials& p : people) {
            std::vector<double> times;
            for (const trial& t : *p.trials)
                if (t.response_time_s && counts(t))
                    times.push_back(*t.response_time_s);
            if (const auto own = median(std::move(times)))
                medians.push_back(*own);
        }
        return median(std::move(medians));
    };
    response_times all{find_median([](const trial&) { return true; })};
    const bool has_method = run.task != task_kind::choose;
    for (std::size_t row = 0; row < (has_method ? run.methods.size() : 1); ++row)
        for (std::size_t m = 0; m < run.motions.size(); ++m)
            all.by.emplace_back((has_method ? run.methods[row] + ":" : "") + run.motions[m],
                                find_median([&](const trial& t) {
                                    return t.motion == m &&
                                           (!has_method || (t.method_1 == row && (t.signal || !run.catches)));
                                }));
    return all;
}

run_analysis analyse_run(const dataset& d, std::size_t which, sigmoid kind)
{
    run_analysis r;
    r.run = d.experiment.runs[which];
    r.function = kind;
    const bool measures = find_task(r.run.task).about().measures;
    std::vector<cell_values> all;
    std::vector<person_trials> people;
    std::vector<std::string> groups;
    std::vector<double> first;
    for (std::size_t i = 0; i < d.participants.size(); ++i) {
        const run_data& own = d.data[i][which];
        r.voids += own.voids;
        r.early += static_cast<std::size_t>(std::ranges::count(own.trials, true, &trial::early));
        if (find_run(d, i, which) != r.run)
            continue; // the results of the group have it
        std::optional<cell_values> v;
        if (!measures)
            v = compute_cells(r.run, own.trials);
        if (measures ? own.trials.empty() : !v) {
            r.missing.push_back({d.participants[i], own.trials.empty()
                                                        ? "no trial counts"
                                                        : "no trial counts in some of the cells"});
            continue;
        }
        r.trials += own.trials.size();
        people.push_back({d.participants[i], &own.trials});
        r.codes.push_back(d.participants[i]);
        groups.push_back(d.groups.empty() ? "" : d.groups[i]);
        if (measures)
            continue;
        all.push_back(*std::move(v));
        const auto first_chosen = std::ranges::count(own.trials, 1U, &trial::response);
        first.push_back(100.0 * static_cast<double>(first_chosen) / static_cast<double>(own.trials.size()));
    }
    r.n = people.size();
    r.times = summarise_times(r.run, people);
    if (measures) {
        r.measures = measure_run(r.run, people, kind);
        const std::vector<std::string> of_all = std::exchange(groups, {});
        for (std::size_t i = 0; i < people.size(); ++i) {
            const std::vector<named_measure> own = list_measures(r.run, r.measures[0].people[i]);
            if (own.empty() || !own[0].second)
                continue;
            all.push_back({{*own[0].second}});
            groups.push_back(of_all[i]);
        }
    } else {
        analyse_values(r, all);
    }
    if (has_groups(r.run, d.experiment.groups) && !has_worths(r.run))
        r.groups_compared = compare_groups(all, groups);
    if (r.run.task == task_kind::choose)
        r.first_interval = test_mean(first, 50.0);
    if (has_worths(r.run))
        r.worths = estimate_worths(r.run, people);
    if (r.run.task == task_kind::identify)
        count_answers(r, people);
    return r;
}

void warn_of_people(analysis& a, const run_analysis& r, const dataset& d, std::size_t which)
{
    for (const left_out& l : r.missing)
        a.warnings.push_back(fmt::format("{}: sub-{} is left out: {}", r.run.name, l.participant, l.why));
    for (std::size_t i = 0; i < d.participants.size(); ++i) {
        const std::size_t count = d.data[i][which].trials.size();
        const std::size_t planned = std::size_t{r.run.trials} * d.data[i][which].sessions;
        if (planned != 0 && count != planned && count != 0)
            a.warnings.push_back(fmt::format("{}: sub-{} has {} that count, of {}", r.run.name,
                                             d.participants[i], counted(count, "trial"), planned));
    }
}

// Says why figures are missing.
void warn_of_figures(analysis& a, const run_analysis& r)
{
    const auto warn = [&](std::string_view figure, std::string_view why) {
        a.no_figures.push_back(fmt::format("{}: {}: {}", r.run.name, figure, why));
    };
    const auto warn_of_test = [&](std::string_view figure, const t_test& t) {
        if (t.n < 2)
            return;
        if (!t.t)
            warn(figure, "no variance over participants, so no t test");
        else if (!t.d_ci)
            warn(figure, "the effect is too large for an interval");
        if (!t.p_signflip)
            warn(figure, "too many participants for the exact test");
    };
    const auto warn_of_cell = [&](const std::string& figure, const t_test& t, std::size_t conditions) {
        if (r.run.task != task_kind::rate)
            warn_of_test(figure, t);
        else if (t.n > 1 && !t.ci)
            warn(figure, "no variance over participants, so no interval");
        if (t.n > 1 && conditions > 1 && !t.ci_within)
            warn(figure, "no variance within participants, so no interval within participants");
    };
    for (std::size_t row = 0; row < r.cells.size(); ++row) {
        const std::string method = r.cells.size() < r.run.methods.size() ? "" : r.run.methods[row] + ", ";
        warn_of_cell(method + "all", r.cells[row].all, r.cells.size());
        for (std::size_t m = 0; m < r.cells[row].motion.size(); ++m)
            warn_of_cell(method + r.run.motions[m], r.cells[row].motion[m],
                         r.cells.size() * r.run.motions.size());
    }
    warn_of_test("first interval", r.first_interval);
    warn_of_test("methods", r.paired);
    for (std::size_t i = 0; i < r.worths.size(); ++i)
        if (r.n != 0 && !r.worths[i].log_worth)
            warn("worth of " + r.run.methods[i],
                 fmt::format("the choices between it and {}, directly and through other methods, all go one "
                             "way or are missing, so it is not finite",
                             r.run.methods[0]));
    const auto warn_of_effect = [&](const std::string& name, const effect& e) {
        if (e.ms_error && !e.f)
            warn(name, "the error has no variance, so no F");
        if (e.epsilon_gg && !e.epsilon_hf)
            warn(name, "too few participants for the epsilon of Huynh and Feldt");
        if (e.epsilon_gg && !e.mauchly_w)
            warn(name, "too few participants, or too little variance, for Mauchly's test");
    };
    warn_of_effect("method", r.effects.first);
    warn_of_effect("motion", r.effects.second);
    warn_of_effect("method:motion", r.effects.interaction);
    for (const auto& [name, e] : list_group_effects(r))
        if (e != nullptr)
            warn_of_effect(fmt::format("groups compared, {}", name), *e);
    if (r.groups_compared && !r.groups_compared->group.ms_error)
        warn("groups", "too few participants to compare them");
    for (std::size_t row = 0; row < r.pairs.size(); ++row)
        if (!r.pairs[row].empty() && !r.pairs[row][0].q && r.n > 1)
            warn(r.run.task == task_kind::choose ? "motion" : r.run.methods[row],
                 "the error has no variance, so no Tukey");
    for (std::size_t row = 0; row < r.paired_motions.size(); ++row)
        for (const paired_comparison& c : r.paired_motions[row])
            if (c.test.n > 1 && !c.test.t)
                warn(fmt::format("{}, {} - {}", r.run.methods[row], r.run.motions[c.a], r.run.motions[c.b]),
                     "no variance over participants, so no t test");
    const std::vector<named_measure> figures = list_measures(r.run, {});
    for (std::size_t k = 0; k < figures.size(); ++k) {
        std::vector<std::string> whose;
        for (std::size_t i = 0; i < r.codes.size(); ++i) {
            std::vector<std::string> in;
            for (const measured_condition& c : r.measures)
                if (!list_measures(r.run, c.people[i])[k].second)
                    in.push_back(c.name.empty() ? "all trials" : c.name);
            if (!in.empty())
                whose.push_back(
                    "sub-" + r.codes[i] +
                    (in.size() < r.measures.size() ? fmt::format(" ({})", fmt::join(in, ", ")) : ""));
        }
        if (!whose.empty())
            warn(figures[k].first,
                 fmt::format("the answers do not determine it: {}", fmt::join(whose, ", ")));
    }
    if (r.n == 1)
        a.no_figures.push_back(r.run.name + ": one participant: tests need two");
}

// Adds the results of everybody, or of a group.
void add_results(analysis& a, const dataset& d, const std::string& group, sigmoid kind)
{
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i) {
        if (d.experiment.runs[i].motions.empty())
            continue; // the group lacks the run
        run_analysis& r = a.runs.emplace_back(analyse_run(d, i, kind));
        r.whole = r.run.name;
        r.group = group;
        if (!group.empty())
            r.run.name = name_result(r.whole, group);
        warn_of_people(a, r, d, i);
        warn_of_figures(a, r);
    }
}

// Returns the value of a trial in its cell: a rating, or per cent.
double score_trial(const trial& t, const run_outline& run)
{
    if (run.task == task_kind::rate)
        return t.response;
    const bool hit =
        run.task == task_kind::choose ? chosen_method(t) + 1 == run.methods.size() : t.response == t.motion;
    return hit ? 100.0 : 0.0;
}

} // namespace

double chance(const run_outline& run) noexcept
{
    return run.task == task_kind::choose ? 50.0
           : run.task == task_kind::rate ? 0.0
                                         : 100.0 / static_cast<double>(run.motions.size());
}

analysis analyse(const dataset& d, sigmoid kind)
{
    analysis a;
    a.experiment = d.experiment.name;
    a.participants = d.participants.size();
    a.simulated = d.simulated;
    a.excluded = d.excluded;
    a.warnings = d.warnings;
    add_results(a, d, "", kind);
    for (const group_outline& g : d.experiment.groups)
        add_results(a, select_group(d, g), g.name, kind);
    return a;
}

std::string name_result(std::string_view run, std::string_view group)
{
    return fmt::format("{}, group {}", run, group);
}

bool has_worths(const run_outline& run) noexcept
{
    return run.task == task_kind::choose && run.methods.size() > 2;
}

bool has_groups(const run_outline& run, const std::vector<group_outline>& groups)
{
    return std::ranges::count_if(groups,
                                 [&](const auto& g) { return std::ranges::count(g.runs, run) != 0; }) > 1;
}

std::vector<std::pair<const char*, const effect*>> list_group_effects(const run_analysis& r)
{
    if (!r.groups_compared)
        return {};
    const mixed_anova& m = *r.groups_compared;
    if (find_task(r.run.task).about().measures)
        return {{"group", &m.group}};
    const bool has_rows = count_rows(r.run) > 1;
    const bool has_motions = r.run.motions.size() > 1;
    const auto there = [](bool varies, const effect& e) { return varies ? &e : nullptr; };
    std::vector<std::pair<const char*, const effect*>> all{
        {"group", &m.group},
        {"motion", there(has_motions, m.within.second)},
        {"group:motion", there(has_motions, m.by_group.second)}};
    if (r.run.task != task_kind::choose)
        all.insert(all.end(),
                   {{"method", there(has_rows, m.within.first)},
                    {"group:method", there(has_rows, m.by_group.first)},
                    {"method:motion", there(has_rows && has_motions, m.within.interaction)},
                    {"group:method:motion", there(has_rows && has_motions, m.by_group.interaction)}});
    return all;
}

std::size_t chosen_method(const trial& t) noexcept
{
    return t.response == 1 ? t.method_1 : t.method_2;
}

std::optional<cell_values> compute_cells(const run_outline& run, const std::vector<trial>& trials)
{
    const std::size_t rows = count_rows(run);
    cell_values sums(rows, std::vector<double>(run.motions.size(), 0.0));
    std::vector<std::vector<std::size_t>> counts(rows, std::vector<std::size_t>(run.motions.size(), 0));
    const auto add = [&](std::size_t row, std::size_t motion, double value) {
        sums[row][motion] += value;
        ++counts[row][motion];
    };
    for (const trial& t : trials)
        if (has_worths(run))
            for (const std::size_t method : {t.method_1, t.method_2})
                add(method, t.motion, method == chosen_method(t) ? 100.0 : 0.0);
        else
            add(run.task == task_kind::choose ? 0 : t.method_1, t.motion, score_trial(t, run));
    for (std::size_t i = 0; i < rows; ++i)
        for (std::size_t j = 0; j < run.motions.size(); ++j) {
            if (counts[i][j] == 0)
                return {};
            sums[i][j] /= static_cast<double>(counts[i][j]);
        }
    return sums;
}

std::vector<std::string> row_methods(const run_outline& run)
{
    return {run.methods.end() - static_cast<std::ptrdiff_t>(count_rows(run)), run.methods.end()};
}

double rounding_in(const run_outline& run) noexcept
{
    return few_digits * (run.task == task_kind::rate ? static_cast<double>(run.scale) : 100.0);
}

std::optional<double> compared_value(const run_outline& run, const cell_values& cells)
{
    if (run.task != task_kind::rate)
        return mean(cells.back());
    if (cells.size() < 2)
        return {};
    const double difference = mean(cells.back()) - mean(cells.front());
    return std::abs(difference) > rounding_in(run) ? difference : 0.0;
}

interval possible_values(const run_outline& run)
{
    return run.task == task_kind::rate ? interval{run.lowest_rating(), run.scale} : per_cents;
}

interval cut_to(const interval& i, const interval& possible)
{
    return {std::max(i.first, possible.first), std::min(i.second, possible.second)};
}

} // namespace tactor::study
