// SPDX-License-Identifier: MIT
#include "study/analysis/power.hpp"

#include <algorithm>
#include <deque>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "study/analysis/levels.hpp"
#include "study/experiment/trials.hpp"
#include "study/statistics/tests.hpp"
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
            one.session = d.session;
            one.place = static_cast<unsigned>(p.trials.size() + 1);
            one.motion = place_in(r.motions, t.motion);
            one.method_1 = place_in(r.methods, d.methods[t.method_1].made_of.value_or(t.method_1));
            if (t.method_2)
                one.method_2 = place_in(r.methods, d.methods[*t.method_2].made_of.value_or(*t.method_2));
            if (const auto odd = find_odd(t))
                one.odd = *odd;
            if (d.methods[t.method_1].name == standard_name)
                one.method_1 = one.method_2;
            p.trials.push_back(one);
        }
        all.push_back(std::move(p));
    }
    return all;
}

// Simulates the answers to the trials of a run, except those of tracks that have ended. Repeats a void trial
// until it is valid. Adds the trials to `played`.
void answer_all(person_run& p, const simulated_observer& who, const experiment_definition& d,
                const run_definition& r, std::vector<trial>& played)
{
    const task& own = task_in(r.outline);
    const auto values = own.choose_values(r);
    std::set<unsigned> ended;
    for (std::size_t i = 0; i < p.trials.size(); ++i) {
        planned_trial& t = p.planned[i];
        if (ended.contains(t.track))
            continue;
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
        played.push_back(p.trials[i]);
        if (t.track == 0)
            continue;
        values->take(t.track, method_1, static_cast<unsigned>(a.response.number));
        if (values->has_ended(t.track))
            ended.insert(t.track);
    }
}

void count(power_at& at, const compared& found)
{
    at.untested += found.p ? 0 : 1;
    if (found.p && *found.p < significant_p) {
        ++at.significant;
        at.for_last += found.is_above ? 1 : 0;
    }
}

// Tests a figure between the levels of a factor with some participants. Leaves out those without a value.
compared compare_levels(std::span<const std::optional<std::vector<double>>> people, std::size_t levels)
{
    std::vector<std::vector<double>> rows;
    for (const auto& row : people)
        if (row)
            rows.push_back(*row);
    std::vector<double> differences; // of the last level from the first
    for (const std::vector<double>& row : rows)
        differences.push_back(row.back() - row.front());
    const t_test pair = quick_test_mean(differences, 0.0);
    const bool is_above = pair.mean.value_or(0.0) > 0.0;
    if (levels == 2)
        return {pair.p, is_above};
    const effect e = repeated_measures({rows, levels, 1}).first;
    return {e.p_gg ? e.p_gg : e.p, is_above};
}

// A run with its participants in all sessions.
struct simulated_study {
    simulated_study(const std::vector<experiment_definition>& sessions, std::size_t r,
                    const power_request& asked, std::size_t most)
        : run(sessions.front().runs[r]), outcome{r, {}}
    {
        for (const experiment_definition& held : sessions)
            people.push_back(
                prepare_people(held, r, run.outline.is_in(held.session.value_or(1)) ? most : 0, asked.seed));
        for (std::size_t i = 0; i < most; ++i) {
            trials.emplace_back();
            for (const auto& session : people)
                if (!session.empty())
                    trials[i].insert(trials[i].end(), session[i].trials.begin(), session[i].trials.end());
        }
        for (const std::vector<trial>& own : trials)
            all.all.push_back({"", &own});
        factors = list_factors(run.outline, all, sigmoid::normal);
        std::erase_if(factors, [](const compared_factor& f) { return f.levels.size() < 2; });
        if (task_in(run.outline).name_comparison(run.outline).against)
            outcome.tests.emplace_back();
        for (const compared_factor& f : factors)
            for (const named_value& figure : f.figures) {
                outcome.tests.push_back({f.name, figure.name.front()});
                for (const level& l : f.levels)
                    outcome.tests.back().levels.push_back(l.name);
            }
        for (tested_power& t : outcome.tests)
            for (const std::size_t n : asked.participants)
                t.at.push_back({n});
    }

    // Simulates a study, and tests each number of participants.
    void simulate(const std::vector<experiment_definition>& sessions, const stimulus_set& stimuli,
                  const simulation& s)
    {
        if (outcome.tests.empty())
            return;
        const task& own = task_in(run.outline);
        std::vector<compared_person> main;
        std::vector<std::vector<std::optional<std::vector<double>>>> figures(outcome.tests.size()); // by test
        for (std::size_t i = 0; i < trials.size(); ++i) {
            trials[i].clear();
            for (std::size_t n = 0; n < sessions.size(); ++n) {
                if (people[n].empty())
                    continue;
                person_run& who = people[n][i];
                answer_all(who, {s, sessions[n], run, stimuli, who.code}, sessions[n], run, trials[i]);
            }
            std::size_t test = 0;
            if (outcome.tests.front().factor.empty()) {
                main.push_back(own.compare(run.outline, trials[i]));
                ++test;
            }
            for (const compared_factor& f : factors)
                for (auto& row : measure_levels(f, trials[i]))
                    figures[test++].push_back(std::move(row));
        }
        for (std::size_t test = 0; test < outcome.tests.size(); ++test) {
            tested_power& t = outcome.tests[test];
            for (power_at& at : t.at)
                count(at, t.factor.empty() ? own.test(run.outline, std::span(main).first(at.participants),
                                                      fmt::format("{}/{}", s.seed, run.outline.name))
                                           : compare_levels(std::span(figures[test]).first(at.participants),
                                                            t.levels.size()));
        }
    }

    const run_definition& run;
    std::vector<std::vector<person_run>> people = {}; // by session
    std::vector<std::vector<trial>> trials = {};      // by participant
    run_people all = {};
    std::vector<compared_factor> factors = {};
    run_power outcome;
};

} // namespace

std::optional<std::vector<run_power>> simulate_power(const experiment_definition& d,
                                                     const stimulus_set& stimuli, const power_request& r,
                                                     const std::function<bool()>& go_on)
{
    const std::size_t most = *std::max_element(r.participants.begin(), r.participants.end());
    std::vector<experiment_definition> sessions(d.outline.sessions, d);
    for (unsigned i = 0; i < sessions.size() && sessions.size() > 1; ++i)
        sessions[i].session = i + 1;
    std::deque<simulated_study> runs; // whose trials stay in place
    for (std::size_t run = 0; run < d.runs.size(); ++run)
        runs.emplace_back(sessions, run, r, most);
    for (std::size_t k = r.studies * (r.part - 1) / r.parts; k < r.studies * r.part / r.parts; ++k) {
        if (!go_on())
            return {};
        simulation s = r.observer;
        s.seed += k;
        for (simulated_study& one : runs)
            one.simulate(sessions, stimuli, s);
    }
    std::vector<run_power> all;
    for (simulated_study& one : runs)
        all.push_back(std::move(one.outcome));
    return all;
}

} // namespace tactor::study
