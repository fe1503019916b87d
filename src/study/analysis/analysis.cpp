// SPDX-License-Identifier: MIT
#include "study/analysis/analysis.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/analysis/levels.hpp"
#include "study/results/measures.hpp"
#include "study/tasks/adaptive.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

response_times summarise_times(const run_outline& run, const std::vector<person_trials>& people)
{
    const task& own = find_run_task(run);
    const auto find_median = [&](const auto& counts) {
        std::vector<double> medians;
        for (const person_trials& p : people) {
            std::vector<double> times;
            for (const trial& t : *p.trials)
                if (t.response_time_s && counts(t))
                    times.push_back(*t.response_time_s);
            if (const auto its = median(std::move(times)))
                medians.push_back(*its);
        }
        return median(std::move(medians));
    };
    response_times all{find_median([](const trial&) { return true; })};
    const std::vector<std::string> methods = own.list_timed_methods(run);
    for (std::size_t row = 0; row < std::max<std::size_t>(methods.size(), 1); ++row)
        for (std::size_t m = 0; m < run.motions.size(); ++m)
            all.by.emplace_back((methods.empty() ? "" : methods[row] + ":") + run.motions[m],
                                find_median([&](const trial& t) {
                                    return t.motion == m &&
                                           (methods.empty() || (t.method_1 == row && !own.is_silent(t)));
                                }));
    return all;
}

run_analysis analyse_run(const dataset& d, std::size_t which, sigmoid kind)
{
    run_analysis r;
    r.run = d.experiment.runs[which];
    r.track_rule = format_stop_rule(r.run.adaptive);
    run_people people{{}, can_compare_groups(r.run, d.experiment.groups)};
    const auto plan = find_run_task(r.run).plan_cells(r.run);
    for (std::size_t i = 0; i < d.participants.size(); ++i) {
        const run_data& own = d.data[i][which];
        r.voids += own.voids;
        r.dropped += own.dropped;
        r.early += static_cast<std::size_t>(std::ranges::count(own.trials, true, &trial::early));
        if (find_run(d, i, which) != r.run)
            continue; // counted in the results of the participant's group
        if (own.trials.empty() || (plan && !compute_cells(r.run, *plan, own.trials))) {
            r.missing.push_back({d.participants[i], own.trials.empty()
                                                        ? "no trial counts"
                                                        : "no trial counts in some of the cells"});
            continue;
        }
        r.trials += own.trials.size();
        people.all.push_back(
            {d.participants[i], &own.trials, d.groups.empty() ? "" : d.groups[i], &own.predictions});
        for (const played_track& t : own.tracks)
            r.tracks.push_back({d.participants[i], t});
    }
    r.n = people.all.size();
    r.times = summarise_times(r.run, people.all);
    r.results = find_run_task(r.run).analyse(r.run, people, kind);
    if (const auto p = find_run_task(r.run).plan_intervals(r.run, kind))
        if (auto row = analyse_intervals(*p, r.run, people))
            r.results.push_back(*std::move(row));
    add_comparisons(r.results, r.run, people, kind);
    return r;
}

void add_people_warnings(analysis& a, const run_analysis& r, const dataset& d, std::size_t which)
{
    for (const excluded_person& l : r.missing)
        a.warnings.push_back(fmt::format("{}: sub-{} is left out: {}", r.run.name, l.participant, l.why));
    for (std::size_t i = 0; i < d.participants.size(); ++i) {
        const std::size_t count = d.data[i][which].trials.size() + d.data[i][which].dropped;
        const std::size_t planned = std::size_t{r.run.trials} * d.data[i][which].sessions;
        const std::vector<played_track>& tracks = d.data[i][which].tracks;
        if (planned == 0 || count == planned || count == 0)
            continue;
        // Each track, in each order of its two stimuli, gets an equal share of the trials, rounded down.
        const std::size_t orders = find_run_task(r.run).plan_intervals(r.run, sigmoid::normal) ? 2 : 1;
        const std::size_t share = tracks.empty() ? 0 : planned / (tracks.size() * orders) * orders;
        const auto is_whole = [share](const played_track& t) { return t.ended || t.trials >= share; };
        if (tracks.empty() || !std::ranges::all_of(tracks, is_whole))
            a.warnings.push_back(fmt::format("{}: sub-{} has {}, of {}{}", r.run.name, d.participants[i],
                                             counted(count, "trial that counts", "trials that count"),
                                             tracks.empty() ? "" : "at most ", planned));
    }
}

// Adds the results of all participants, or of one group if `group` is not empty.
void add_results(analysis& a, const dataset& d, const std::string& group, sigmoid kind)
{
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i) {
        if (d.experiment.runs[i].motions.empty())
            continue; // the group skips the run
        run_analysis& r = a.runs.emplace_back(analyse_run(d, i, kind));
        r.whole = r.run.name;
        r.group = group;
        if (!group.empty())
            r.run.name = format_result_name(r.whole, group);
        add_people_warnings(a, r, d, i);
        explained_figures weak = explain_figures(r);
        std::ranges::move(weak.missing, std::back_inserter(a.no_figures));
        std::ranges::move(weak.doubtful, std::back_inserter(a.warnings));
    }
}

} // namespace

analysis analyse(const dataset& d, sigmoid kind)
{
    analysis a;
    a.experiment = d.experiment.name;
    a.participants = d.participants.size();
    a.simulated = d.simulated;
    a.excluded = d.excluded;
    a.drop_rule = d.drop_rule;
    a.warnings = d.warnings;
    add_results(a, d, "", kind);
    for (const group_outline& g : d.experiment.groups)
        add_results(a, select_group(d, g), g.name, kind);
    return a;
}

std::string format_result_name(std::string_view run, std::string_view group)
{
    return fmt::format("{}, group {}", run, group);
}

bool can_compare_groups(const run_outline& run, const std::vector<group_outline>& groups)
{
    return std::ranges::count_if(groups,
                                 [&](const auto& g) { return std::ranges::count(g.runs, run) != 0; }) > 1;
}

std::set<session_number> list_played_sessions(const dataset& d, std::size_t run)
{
    std::set<session_number> sessions;
    for (const std::vector<run_data>& own : d.data)
        for (const trial& t : own[run].trials)
            sessions.insert(t.session);
    return sessions;
}

model_factors find_model_factors(const dataset& d, std::size_t run)
{
    return {can_compare_groups(d.experiment.runs[run], d.experiment.groups),
            list_played_sessions(d, run).size() > 1};
}

} // namespace tactor::study
