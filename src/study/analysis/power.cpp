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

// A participant's trials of a run: as planned, and as the analysis reads them.
struct person_run {
    std::string code;
    std::vector<planned_trial> planned = {};
    std::vector<trial> trials = {};
};

std::size_t place_in(const std::vector<std::size_t>& places, std::size_t of)
{
    return static_cast<std::size_t>(std::find(places.begin(), places.end(), of) - places.begin());
}

// Prepares a run for n participants, without their answers.
std::vector<person_run> prepare_people(const experiment_definition& d, std::size_t run, std::size_t n,
                                       const std::optional<std::uint64_t>& seed)
{
    const run_definition& r = d.runs[run];
    std::vector<person_run> all;
    for (std::size_t i = 1; i <= n; ++i) {
        person_run p{fmt::format("{:02}", i)};
        p.planned = make_run(d, run, p.code, seed.value_or(d.seed.value_or(default_seed(p.code)))).trials;
        for (const planned_trial& t : p.planned) {
            trial one;
            one.place = static_cast<unsigned>(p.trials.size() + 1);
            one.motion = place_in(r.motions, t.motion);
            one.method_1 = place_in(r.methods, d.methods[t.method_1].made_of.value_or(t.method_1));
            if (t.method_2)
                one.method_2 = place_in(r.methods, d.methods[*t.method_2].made_of.value_or(*t.method_2));
            if (d.methods[t.method_1].name == standard_name)
                one.method_1 = one.method_2;
            p.trials.push_back(one);
        }
        all.push_back(std::move(p));
    }
    return all;
}

// Simulates the answers to all trials of a run. Repeats a void trial until it is valid.
void answer_all(person_run& p, const simulated_observer& who, const experiment_definition& d,
                const run_definition& r)
{
    const task& own = task_in(r.outline);
    const auto values = own.choose_values(r);
    for (std::size_t i = 0; i < p.trials.size(); ++i) {
        planned_trial& t = p.planned[i];
        values->choose(t);
        simulated_answer a;
        unsigned attempt = 0;
        do
            a = who.answer(t, p.trials[i].place, ++attempt, false);
        while (a.is_void);
        p.trials[i].value = find_value(d, t).value_or(0.0);
        if (const auto target = read_drawing(own.write_target(d.motions[t.motion])))
            p.trials[i].target = *target;
        const std::string& method_1 = d.methods[t.method_1].name;
        own.score(p.trials[i], r.outline, method_1, a.response);
        values->take(t.track, method_1, static_cast<unsigned>(a.response.number));
    }
}

// Tests one study with its first n participants. Leaves out a participant without a value, who lacks a cell,
// as the analysis does.
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
