// SPDX-License-Identifier: MIT
#include "study/tasks/draw.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

namespace tactor::study {
namespace {

// Returns a trial. Exchanges the methods of a pair if `swapped`.
planned_trial swap_methods(planned_trial t, bool swapped)
{
    if (t.method_2 && swapped)
        std::swap(t.method_1, *t.method_2);
    return t;
}

std::size_t count_catch_trials(const run_definition& r, std::size_t trials)
{
    return static_cast<std::size_t>(std::llround(r.catch_share * static_cast<double>(trials)));
}

void add_catch_trials(std::vector<planned_trial>& all, const run_definition& r, std::size_t n)
{
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t method = r.methods[i / r.motions.size() % r.methods.size()];
        all.push_back({r.motions[i % r.motions.size()], *r.variants.at(method).silent});
    }
}

} // namespace

std::vector<planned_trial> draw_cells(const run_definition& r, std::vector<planned_trial> cells,
                                      std::size_t n, random_numbers& numbers)
{
    const std::size_t catches = count_catch_trials(r, n);
    std::vector<planned_trial> all;
    for (std::size_t i = 0; i < n - catches; ++i) {
        if (i == n - catches - (n - catches) % cells.size())
            shuffle(std::span(cells), numbers);
        all.push_back(cells[i % cells.size()]);
    }
    add_catch_trials(all, r, catches);
    return all;
}

std::vector<planned_trial> draw_by_turns(const experiment_definition& d, const run_definition& r,
                                         std::vector<planned_trial> cells, random_numbers& numbers)
{
    shuffle(std::span(cells), numbers);
    // Sorts the cells by two numbers. The first number counts the earlier cells with the same motion and
    // method. The second number counts the earlier cells that have the same motion and the same first number.
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> cells_before;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> turns_before;
    std::multimap<std::pair<std::size_t, std::size_t>, planned_trial> turns;
    for (const planned_trial& t : cells) {
        const std::size_t method = d.methods[t.method_1].made_of.value_or(t.method_1);
        const std::size_t turn = cells_before[{t.motion, method}]++;
        turns.emplace(std::pair(turn, turns_before[{t.motion, turn}]++), t);
    }
    const std::size_t catches = count_catch_trials(r, r.outline.trials);
    std::vector<planned_trial> all;
    for (const auto& [turn, t] : turns)
        if (all.size() < r.outline.trials - catches)
            all.push_back(t);
    add_catch_trials(all, r, catches);
    return all;
}

std::vector<planned_trial> cross_motions(const run_definition& r, const condition_list& conditions)
{
    std::vector<planned_trial> cells;
    for (const std::size_t motion : r.motions)
        for (const planned_trial& t : conditions(motion, r.methods)) {
            cells.push_back(t);
            if (t.method_2)
                cells.push_back(swap_methods(t, true));
        }
    return cells;
}

std::vector<planned_trial> draw_balanced_trials(const run_definition& r, const condition_list& conditions,
                                                std::size_t n, random_numbers& numbers)
{
    const std::vector<planned_trial> cells = cross_motions(r, conditions);
    const std::size_t whole = n - n % cells.size();
    std::vector<planned_trial> all;
    for (std::size_t i = 0; i < whole; ++i)
        all.push_back(cells[i % cells.size()]);
    if (whole == n)
        return all;
    std::vector<std::size_t> motions = r.motions;
    std::vector<std::size_t> methods = r.methods;
    shuffle(std::span(motions), numbers);
    shuffle(std::span(methods), numbers);
    // Combines each motion with each condition once. Both lists advance by one for each trial. Before a
    // combination repeats, the list of conditions advances by one more. After all combinations, continues
    // with the other order of each pair.
    const std::vector<planned_trial> listed = conditions(0, methods);
    const std::size_t kinds = listed.size();
    const std::size_t half = motions.size() * kinds;
    for (std::size_t i = 0; whole + i < n; ++i) {
        const std::size_t at = i % half;
        planned_trial t = swap_methods(listed[(at + at / std::lcm(motions.size(), kinds)) % kinds],
                                       (at / kinds + i / half) % 2 == 1);
        t.motion = motions[at % motions.size()];
        all.push_back(t);
    }
    return all;
}

std::vector<planned_trial> list_methods(std::size_t motion, const std::vector<std::size_t>& methods)
{
    std::vector<planned_trial> all;
    for (const std::size_t method : methods)
        all.push_back({motion, method});
    return all;
}

} // namespace tactor::study
