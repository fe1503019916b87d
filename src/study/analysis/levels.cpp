// SPDX-License-Identifier: MIT
#include "study/analysis/levels.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "study/results/cells.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

std::vector<level> list_method_levels(const run_outline& run)
{
    std::vector<level> all;
    for (std::size_t m = 0; m < run.methods.size(); ++m)
        all.push_back({run.methods[m], [&own = find_run_task(run), m](const trial& t) {
                           return t.method_1 == m || own.is_silent(t);
                       }});
    return all;
}

std::vector<level> list_session_levels(const run_people& people)
{
    std::set<unsigned> numbers;
    for (const person_trials& p : people.all)
        for (const trial& t : *p.trials)
            if (t.session)
                numbers.insert(*t.session);
    std::vector<level> all;
    for (const unsigned n : numbers)
        all.push_back({fmt::format("{}", n), [n](const trial& t) { return t.session == n; }});
    return all;
}

// Replaces the angles of all participants at all levels by the result of unwrap_angles().
void join_all_angles(std::vector<std::vector<double>>& rows)
{
    std::vector<double> all;
    for (const std::vector<double>& own : rows)
        all.insert(all.end(), own.begin(), own.end());
    all = unwrap_angles(std::move(all));
    auto next = all.begin();
    for (std::vector<double>& own : rows)
        for (double& value : own)
            value = *next++;
}

// Returns the means of a group, or of all participants if `group` is empty.
level_means average_levels(const level_values& v, std::size_t levels, const std::string& group)
{
    level_means m{group};
    m.values.resize(levels);
    std::vector<std::vector<double>> rows;
    std::vector<double> overall;
    for (std::size_t i = 0; i < v.rows.size(); ++i) {
        if (!group.empty() && v.groups[i] != group)
            continue;
        rows.push_back(v.rows[i]);
        overall.push_back(mean(v.rows[i]));
        for (std::size_t k = 0; k < levels; ++k)
            m.values[k].push_back(v.rows[i][k]);
    }
    const auto within = within_participant_intervals(rows);
    for (std::size_t k = 0; k < levels; ++k) {
        m.means.push_back(omit_test(test_mean(m.values[k], 0.0)));
        if (!rows.empty())
            m.means.back().ci_within = within[k];
    }
    m.overall = omit_test(test_mean(overall, 0.0));
    return m;
}

// Compares a figure between levels.
figure_comparison compare_levels(const std::string& factor, const std::string& figure,
                                 const std::vector<level>& levels, const level_values& v, bool groups)
{
    figure_comparison c{.factor = factor, .figure = figure};
    for (const level& l : levels)
        c.levels.push_back(l.name);
    c.all = average_levels(v, levels.size(), "");
    c.pairs = compare_pairs(c.all.values, 0.0, test_mean);
    if (levels.size() > 2)
        c.anova = analyse_repeated_measures({v.rows, levels.size(), 1}).first;
    if (groups) {
        c.groups = compute_group_effects(factor, levels.size(), v);
        std::vector<std::vector<double>> means;
        for (const std::string& g : std::set(v.groups.begin(), v.groups.end())) {
            c.by_group.push_back(average_levels(v, levels.size(), g));
            means.emplace_back();
            for (std::size_t i = 0; i < v.rows.size(); ++i)
                if (v.groups[i] == g)
                    means.back().push_back(mean(v.rows[i]));
        }
        c.group_pairs = compare_group_pairs(means);
    }
    return c;
}

// Returns a function that computes a participant's mean over all cells. The mean is missing if a cell has no
// trial.
auto make_cell_measure(const run_outline& run, const cell_plan& plan)
{
    return [&run, plan](const std::vector<trial>& trials) {
        std::optional<double> all;
        if (const auto cells = compute_cells(run, plan, trials)) {
            std::vector<double> rows;
            for (const std::vector<double>& row : *cells)
                rows.push_back(mean(row));
            all = mean(rows);
        }
        return std::vector<named_value>{{{plan.figure}, all}};
    };
}

// Returns a plan with one row, for trials that all have the same method.
cell_plan plan_one_method(cell_plan plan)
{
    plan.methods.resize(1);
    plan.score = [score = plan.score](const trial& t) {
        auto all = score(t);
        for (auto& [row, value] : all)
            row = 0;
        return all;
    };
    return plan;
}

// Returns true if the results of the run's task already test the difference between two methods.
bool has_difference_test(const run_outline& run)
{
    if (run.methods.size() != 2)
        return false;
    for (const std::vector<result_outline>& form : find_run_task(run).outline_results())
        for (const result_outline& row : form)
            if (std::holds_alternative<method_difference>(row.value))
                return true;
    return false;
}

void add_factor(std::vector<result>& results, const run_people& people, const compared_factor& f)
{
    if (f.levels.empty() || (f.levels.size() < 2 && !people.compares_groups))
        return;
    std::vector<level_values> values(f.figures.size());
    for (const person_trials& p : people.all) {
        const auto found = measure_levels(f, *p.trials);
        for (std::size_t k = 0; k < found.size(); ++k)
            if (found[k]) {
                values[k].rows.push_back(*found[k]);
                values[k].groups.push_back(p.group);
            }
    }
    for (std::size_t k = 0; k < f.figures.size(); ++k) {
        const std::string& name = f.figures[k].name.front();
        if (f.figures[k].is_angle)
            join_all_angles(values[k].rows);
        results.push_back({{f.name + "s", name},
                           f.levels.size() > 1 ? fmt::format("{} by {}, within participants", name, f.name)
                                               : fmt::format("{} by group", name),
                           compare_levels(f.name, name, f.levels, values[k], people.compares_groups)});
    }
}

} // namespace

effect_list compute_group_effects(const std::string& factor, std::size_t levels, const level_values& v)
{
    std::vector<cell_values> cells;
    for (const std::vector<double>& own : v.rows) {
        cells.emplace_back();
        for (const double value : own)
            cells.back().push_back({value});
    }
    const mixed_anova m = compare_groups(cells, v.groups);
    const auto if_several = [levels](const effect& e) {
        return levels > 1 ? std::optional(e) : std::nullopt;
    };
    return {{{"group", m.group},
             {factor, if_several(m.within.first)},
             {"group:" + factor, if_several(m.by_group.first)}},
            true};
}

std::vector<compared_factor> list_factors(const run_outline& run, const run_people& people, sigmoid kind)
{
    const task& own = find_run_task(run);
    std::vector<compared_factor> all;
    if (const auto plan = own.plan_cells(run)) {
        if (plan->figure.empty())
            return {};
        if (own.has_one_method(run) && plan->methods.size() > (has_difference_test(run) ? 2U : 1U))
            all.push_back({"method",
                           list_method_levels(run),
                           {{{plan->figure}}},
                           make_cell_measure(run, plan_one_method(*plan))});
        if (std::vector<level> sessions = list_session_levels(people); sessions.size() > 1)
            all.push_back(
                {"session", std::move(sessions), {{{plan->figure}}}, make_cell_measure(run, *plan)});
        return all;
    }
    const auto measure = [&run, &own, kind](const std::vector<trial>& trials) {
        return own.measure(run, trials, kind);
    };
    const std::vector<named_value> figures = measure({});
    if (own.has_one_method(run))
        all.push_back({"method", list_method_levels(run), figures, measure});
    all.push_back({"session", list_session_levels(people), figures, measure});
    return all;
}

std::optional<compared_factor> find_group_factor(const run_outline& run, sigmoid kind)
{
    const task& own = find_run_task(run);
    if (own.has_one_method(run) && !own.plan_cells(run))
        return list_factors(run, {}, kind).front();
    const std::vector<level> all{{"", [](const trial&) { return true; }}};
    if (const auto plan = own.plan_cells(run)) {
        if (plan->figure.empty() && plan->methods.size() > 1)
            return {}; // each choice of a method is a choice against another
        return compared_factor{
            "", all, {{{plan->figure.empty() ? "chosen" : plan->figure}}}, make_cell_measure(run, *plan)};
    }
    const auto measure = [&run, &own, kind](const std::vector<trial>& trials) {
        return std::vector{own.measure(run, trials, kind).front()};
    };
    return compared_factor{"", all, measure({}), measure};
}

std::vector<std::optional<std::vector<double>>> measure_levels(const compared_factor& f,
                                                               const std::vector<trial>& trials)
{
    std::vector<std::optional<std::vector<double>>> rows(f.figures.size(), std::vector<double>());
    for (const level& l : f.levels) {
        std::vector<trial> own;
        std::ranges::copy_if(trials, std::back_inserter(own), l.has);
        const std::vector<named_value> found = f.measure(own);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            if (!found[k].value)
                rows[k].reset();
            if (rows[k])
                rows[k]->push_back(*found[k].value);
        }
    }
    return rows;
}

void add_comparisons(std::vector<result>& results, const run_outline& run, const run_people& people,
                     sigmoid kind)
{
    for (const compared_factor& f : list_factors(run, people, kind))
        add_factor(results, people, f);
}

} // namespace tactor::study
