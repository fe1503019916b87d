// SPDX-License-Identifier: MIT
#include "study/results/cells.hpp"

#include <iterator>
#include <set>

namespace tactor::study {
namespace {

constexpr const char* group_heading = "Analysis of variance with the group as a factor between participants";

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

// Tests the participants' values in one row of cells: first the means over motions, then each motion.
std::vector<cell_mean> test_row(const std::vector<cell_values>& all, std::size_t row,
                                const std::vector<std::string>& motions, double against)
{
    std::vector<cell_mean> means{{"all"}};
    for (const cell_values& v : all)
        means[0].values.push_back(mean(v[row]));
    std::vector<std::optional<double>> p;
    for (std::size_t m = 0; m < motions.size(); ++m) {
        cell_mean& one = means.emplace_back(cell_mean{motions[m]});
        for (const cell_values& v : all)
            one.values.push_back(v[row][m]);
    }
    for (cell_mean& one : means) {
        one.test = test_mean(one.values, against);
        p.push_back(one.test.p);
    }
    p.erase(p.begin()); // p of "all"
    p = holm(p);
    for (std::size_t m = 0; m < motions.size(); ++m)
        means[m + 1].p_holm = p[m];
    return means;
}

// Adds within-participant intervals to the means of cells, and to the means of rows over motions.
void add_within_intervals(std::vector<cell_means>& rows, const std::vector<cell_values>& all,
                          std::size_t motions, double rounding)
{
    const auto cells =
        within_participant_intervals(lay_out_cells(all, 0, rows.size(), motions).values, rounding);
    std::vector<std::vector<double>> means;
    for (const cell_values& v : all) {
        means.emplace_back();
        for (const std::vector<double>& row : v)
            means.back().push_back(mean(row));
    }
    const auto ends = within_participant_intervals(means, rounding);
    for (std::size_t row = 0; row < ends.size(); ++row) {
        rows[row].means[0].test.ci_within = ends[row];
        for (std::size_t m = 0; m < motions; ++m)
            rows[row].means[m + 1].test.ci_within = cells[row * motions + m];
    }
}

// Returns an effect; nothing for a factor with one level.
std::optional<effect> make_optional_effect(bool varies, const effect& e)
{
    return varies ? std::optional(e) : std::nullopt;
}

} // namespace

std::optional<cell_values> compute_cells(const run_outline& run, const cell_plan& plan,
                                         const std::vector<trial>& trials)
{
    const std::size_t motions = run.motions.size();
    cell_values sums(plan.methods.size(), std::vector<double>(motions, 0.0));
    std::vector<std::vector<std::size_t>> counts(plan.methods.size(), std::vector<std::size_t>(motions, 0));
    for (const trial& t : trials)
        for (const auto& [row, value] : plan.score(t)) {
            sums[row][t.motion] += value;
            ++counts[row][t.motion];
        }
    for (std::size_t i = 0; i < sums.size(); ++i)
        for (std::size_t j = 0; j < motions; ++j) {
            if (counts[i][j] == 0)
                return {};
            sums[i][j] /= static_cast<double>(counts[i][j]);
        }
    return sums;
}

std::vector<named_value> list_cell_values(const run_outline& run, const cell_plan& plan,
                                          const std::vector<trial>& trials)
{
    const auto cells = compute_cells(run, plan, trials);
    std::vector<named_value> all;
    for (std::size_t row = 0; row < plan.methods.size(); ++row)
        for (std::size_t m = 0; m < run.motions.size(); ++m)
            all.push_back({{plan.methods[row], run.motions[m]},
                           cells ? std::optional((*cells)[row][m]) : std::nullopt});
    return all;
}

std::vector<cell_values> compute_all_cells(const run_outline& run, const cell_plan& plan,
                                           const run_people& people)
{
    std::vector<cell_values> all;
    for (const person_trials& p : people.all)
        all.push_back(compute_cells(run, plan, *p.trials).value());
    return all;
}

std::vector<cell_means> test_cells(const run_outline& run, const cell_plan& plan,
                                   const std::vector<cell_values>& all)
{
    std::vector<cell_means> rows;
    const bool is_joint = plan.methods.size() == 1 && run.methods.size() > 1; // one row for all methods
    for (const std::string& method : plan.methods)
        rows.push_back({is_joint ? "" : method, plan.axis, plan.against, plan.possible, plan.methods.size(),
                        test_row(all, rows.size(), run.motions, plan.against.value_or(0.0))});
    add_within_intervals(rows, all, run.motions.size(), plan.rounding());
    return rows;
}

effect_list list_effects(const run_outline& run, const std::vector<cell_values>& all, bool methods)
{
    const std::size_t motions = run.motions.size();
    const std::size_t rows = methods ? run.methods.size() : 1;
    const anova a = analyse_repeated_measures(lay_out_cells(all, 0, rows, motions));
    effect_list list;
    if (methods)
        list.effects.emplace_back("method", make_optional_effect(rows > 1, a.first));
    list.effects.emplace_back("motion", make_optional_effect(motions > 1, a.second));
    if (methods)
        list.effects.emplace_back("method:motion",
                                  make_optional_effect(rows > 1 && motions > 1, a.interaction));
    return list;
}

tukey_list compare_by_tukey(const std::vector<cell_values>& all, std::size_t row, const cell_means& means)
{
    tukey_list list{means.method};
    std::vector<double> values;
    for (std::size_t m = 1; m < means.means.size(); ++m) {
        list.motions.push_back(means.means[m].name);
        if (!means.means[m].test.mean)
            return list;
        values.push_back(*means.means[m].test.mean);
    }
    const effect e = analyse_repeated_measures(lay_out_cells(all, row, 1, values.size())).second;
    list.pairs = tukey(values, all.size(), e.ms_error, e.df2);
    return list;
}

paired_list compare_in_pairs(const cell_means& means, double rounding)
{
    paired_list list{means.method};
    std::vector<std::vector<double>> values;
    for (std::size_t m = 1; m < means.means.size(); ++m) {
        list.motions.push_back(means.means[m].name);
        values.push_back(means.means[m].values);
    }
    list.pairs = compare_pairs(values, rounding);
    return list;
}

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

void add_groups(std::vector<result>& results, const run_outline& run, const run_people& people,
                const std::vector<cell_values>& all, bool methods)
{
    if (!people.compares_groups)
        return;
    const std::size_t rows = run.methods.size();
    const std::size_t motions = run.motions.size();
    std::vector<std::string> groups;
    for (const person_trials& p : people.all)
        groups.push_back(p.group);
    const mixed_anova m = compare_groups(all, groups);
    effect_list list{{{"group", m.group},
                      {"motion", make_optional_effect(motions > 1, m.within.second)},
                      {"group:motion", make_optional_effect(motions > 1, m.by_group.second)}},
                     true};
    if (methods)
        list.effects.insert(
            list.effects.end(),
            {{"method", make_optional_effect(rows > 1, m.within.first)},
             {"group:method", make_optional_effect(rows > 1, m.by_group.first)},
             {"method:motion", make_optional_effect(rows > 1 && motions > 1, m.within.interaction)},
             {"group:method:motion", make_optional_effect(rows > 1 && motions > 1, m.by_group.interaction)}});
    results.push_back({{"group_anova"}, group_heading, std::move(list)});
}

void add_groups(std::vector<result>& results, const run_people& people,
                const std::vector<std::optional<double>>& values)
{
    if (!people.compares_groups)
        return;
    std::vector<cell_values> all;
    std::vector<std::string> groups;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i]) {
            all.push_back({{*values[i]}});
            groups.push_back(people.all[i].group);
        }
    results.push_back(
        {{"group_anova"}, group_heading, effect_list{{{"group", compare_groups(all, groups).group}}, true}});
}

} // namespace tactor::study
