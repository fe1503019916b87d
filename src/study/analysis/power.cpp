// SPDX-License-Identifier: MIT
#include "study/analysis/power.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "study/experiment/trials.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

// Tests one study by its first participants. One without a value lacks a cell and is left out, as in the
// analysis.
void count_study(power_at& at, std::span<const compared_person> people, const run_outline& run,
                 std::string_view seed)
{
    const compared found = task_in(run).test(run, people.first(at.participants), seed);
    at.untested += found.p ? 0 : 1;
    if (found.p && *found.p < significant_p) {
        ++at.significant;
        at.for_last += found.is_above ? 1 : 0;
    }
}

} // namespace

std::optional<std::vector<run_power>> simulate_power(const experiment_definition& d,
                                                     const stimulus_set& stimuli, const power_request& r,
                                                     const std::function<bool()>& go_on)
{
    const std::size_t most = *std::max_element(r.participants.begin(), r.participants.end());
    std::vector<experiment_definition> sessions(d.outline.sessions, d);
    for (unsigned i = 0; i < sessions.size() && sessions.size() > 1; ++i)
        sessions[i].session = i + 1;
    std::vector<run_power> all;
    std::vector<std::vector<std::vector<person_run>>> people; // by run and session
    for (std::size_t run = 0; run < d.runs.size(); ++run) {
        people.emplace_back();
        for (const experiment_definition& held : sessions)
            people[run].push_back(prepare_people(held, run, most, r.seed));
        all.push_back({run, {}});
        const run_outline& o = d.runs[run].outline;
        if (task_in(o).name_comparison(o).against)
            for (const std::size_t n : r.participants)
                all[run].at.push_back({n});
    }
    for (std::size_t k = r.studies * (r.part - 1) / r.parts; k < r.studies * r.part / r.parts; ++k) {
        if (!go_on())
            return {};
        simulation s = r.observer;
        s.seed += k;
        for (run_power& p : all) {
            if (p.at.empty())
                continue;
            const run_definition& run = d.runs[p.run];
            std::vector<compared_person> all_people;
            for (std::size_t i = 0; i < most; ++i) {
                std::vector<trial> trials;
                for (std::size_t n = 0; n < sessions.size(); ++n) {
                    person_run& who = people[p.run][n][i];
                    answer_all(who, {s, sessions[n], run, stimuli, who.code}, d, run);
                    trials.insert(trials.end(), who.trials.begin(), who.trials.end());
                }
                all_people.push_back(task_in(run.outline).compare(run.outline, trials));
            }
            for (power_at& at : p.at)
                count_study(at, all_people, run.outline, fmt::format("{}/{}", s.seed, run.outline.name));
        }
    }
    return all;
}

} // namespace tactor::study
