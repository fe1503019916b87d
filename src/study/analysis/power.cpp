// SPDX-License-Identifier: MIT
#include "study/analysis/power.hpp"

#include <algorithm>
#include <deque>
#include <iterator>
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

std::size_t find_place_index(const std::vector<std::size_t>& places, std::size_t of)
{
    return static_cast<std::size_t>(std::find(places.begin(), places.end(), of) - places.begin());
}

// Prepares the trials of a run for n participants, without answers. `prefix`: start of the participants'
// codes.
std::vector<person_run> prepare_people(const experiment_definition& d, std::size_t run, std::size_t n,
                                       const std::optional<std::uint64_t>& seed, const std::string& prefix)
{
    const run_definition& r = d.runs[run];
    std::vector<person_run> all;
    for (std::size_t i = 1; i <= n; ++i) {
        person_run p{fmt::format("{}{:02}", prefix, i)};
        p.planned = make_run(d, run, p.code, seed.value_or(d.seed.value_or(default_seed(p.code)))).trials;
        for (const planned_trial& t : p.planned) {
            trial one;
            one.session = d.session;
            one.place = static_cast<unsigned>(p.trials.size() + 1);
            one.motion = find_place_index(r.motions, t.motion);
            one.method_1 = find_place_index(r.methods, d.methods[t.method_1].made_of.value_or(t.method_1));
            if (t.method_2)
                one.method_2 =
                    find_place_index(r.methods, d.methods[*t.method_2].made_of.value_or(*t.method_2));
            if (const auto odd = find_odd_stimulus(t))
                one.odd = *odd;
            if (d.methods[t.method_1].name == standard_name)
                one.method_1 = one.method_2;
            p.trials.push_back(one);
        }
        all.push_back(std::move(p));
    }
    return all;
}

// Simulates the answers to the trials of a run. Skips trials of tracks that have ended. Repeats a void trial
// until it is valid. Adds the trials to `played`.
void simulate_answers(person_run& p, const simulated_observer& who, const experiment_definition& d,
                      const run_definition& r, std::vector<trial>& played)
{
    const task& own = find_run_task(r.outline);
    const auto values = own.make_value_chooser(r);
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
        if (const auto target = read_drawing(own.format_target(d.motions[t.motion])))
            p.trials[i].target = *target;
        const std::string& method_1 = d.methods[t.method_1].name;
        own.score(p.trials[i], r.outline, method_1, a.response);
        played.push_back(p.trials[i]);
        if (t.track == 0)
            continue;
        values->record_answer(t.track, method_1, static_cast<unsigned>(a.response.number));
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

// Values of a figure at all levels, by participant. Missing for a participant who lacks the value of a level.
using level_rows = std::span<const std::optional<std::vector<double>>>;

// Tests whether a figure differs between the levels of a factor. Leaves out participants without values.
compared compare_levels(level_rows people)
{
    std::vector<std::vector<double>> rows;
    for (const auto& row : people)
        if (row)
            rows.push_back(*row);
    std::vector<double> differences; // last level minus first level
    for (const std::vector<double>& row : rows)
        differences.push_back(row.back() - row.front());
    const t_test pair = test_mean_quickly(differences, 0.0);
    const bool is_above = pair.mean.value_or(0.0) > 0.0;
    if (rows.empty() || rows.front().size() == 2)
        return {pair.p, is_above};
    const effect e = analyse_repeated_measures({rows, rows.front().size(), 1}).first;
    return {e.p_gg ? e.p_gg : e.p, is_above};
}

// Compares the groups by the means over the levels or, if `by_level`, by the differences between the levels.
// `people` has `most` participants of each group; only the first n of each group count.
compared compare_groups(level_rows people, std::size_t most, std::size_t n, bool by_level)
{
    level_values v;
    std::vector<double> means; // by group
    for (std::size_t first = 0; first < people.size(); first += most) {
        std::vector<double> own;
        for (const auto& row : people.subspan(first, n))
            if (row) {
                v.rows.push_back(*row);
                v.groups.push_back(fmt::format("{:04}", first / most));
                own.push_back(by_level ? row->back() - row->front() : mean(*row));
            }
        if (own.size() < 2)
            return {};
        means.push_back(mean(own));
    }
    const effect_list all = compute_group_effects("level", v.rows.front().size(), v);
    const effect& e = *all.effects[by_level ? 2 : 0].second;
    return {e.p_gg ? e.p_gg : e.p, means.back() > means.front()};
}

// Lists the groups that are compared in a run: all groups that do the whole run. Lists only the group of `d`,
// which may be "", if this group does not do the whole run or there are no groups.
std::vector<std::string> list_compared_groups(const experiment_definition& d, const run_outline& run)
{
    std::vector<std::string> all;
    if (std::ranges::count(d.outline.runs, run) != 0) // otherwise analyze does not compare groups
        for (const group_outline& g : d.outline.groups)
            if (std::ranges::count(g.runs, run) != 0)
                all.push_back(g.name);
    return all.empty() ? std::vector{d.group} : all;
}

// Subject of a test: a figure, or the main comparison of a run if there is no figure.
struct planned_test {
    std::optional<std::size_t> figure = {}; // index of the figure
    bool between_groups = false;
    bool by_level = false; // true for the interaction of groups and levels
};

// A run with its participants in all sessions.
struct simulated_study {
    simulated_study(const std::vector<experiment_definition>& sessions, std::size_t r,
                    const power_request& asked, std::size_t n)
        : run(sessions.front().runs[r]),
          groups(list_compared_groups(sessions.front(), run.outline)),
          most(n),
          own_from(most * static_cast<std::size_t>(std::ranges::find(groups, sessions.front().group) -
                                                   groups.begin())),
          trials(most * groups.size()),
          outcome{r, {}}
    {
        for (const std::string& group : groups) {
            people.emplace_back();
            held.push_back(sessions);
            for (experiment_definition& one : held.back()) {
                one.group = group;
                const std::size_t has_run = run.outline.is_in_session(one.session.value_or(1)) ? most : 0;
                people.back().push_back(prepare_people(
                    one, r, has_run, asked.seed,
                    group != sessions.front().group ? fmt::format("group{}x", held.size()) : ""));
            }
        }
        run_people all;
        for (std::size_t i = 0; i < most; ++i) {
            for (const auto& session : people.front())
                if (!session.empty())
                    trials[i].insert(trials[i].end(), session[i].trials.begin(), session[i].trials.end());
            all.all.push_back({"", &trials[i]});
        }
        if (find_run_task(run.outline).name_comparison(run.outline).against)
            add_test({}, {}, asked);
        std::size_t figures = 0;
        const auto add = [&](const compared_factor& f, const planned_test& p, const tested_power& t) {
            for (std::size_t k = 0; k < f.figures.size(); ++k)
                add_test({p.figure.value_or(0) + k, p.between_groups, p.by_level},
                         {t.factor, f.figures[k].name.front(), t.levels}, asked);
        };
        for (compared_factor& f : list_factors(run.outline, all, sigmoid::normal)) {
            if (f.levels.size() < 2)
                continue;
            std::vector<std::string> names;
            std::ranges::transform(f.levels, std::back_inserter(names), &level::name);
            add(f, {figures}, {f.name, {}, std::move(names)});
            figures += f.figures.size();
            factors.push_back(std::move(f));
        }
        const auto between =
            groups.size() > 1 ? find_group_factor(run.outline, sigmoid::normal) : std::nullopt;
        if (!between)
            return;
        const bool by_level = between->levels.size() > 1; // then `between` is the first of `factors`
        add(*between, {by_level ? 0 : figures, true}, {"group", {}, groups});
        if (by_level)
            add(*between, {0, true, true}, {"group:" + between->name, {}, groups});
        else
            factors.push_back(*between);
    }

    void add_test(const planned_test& p, tested_power t, const power_request& asked)
    {
        for (const std::size_t n : asked.participants)
            t.at.push_back({n});
        plans.push_back(p);
        outcome.tests.push_back(std::move(t));
    }

    // Simulates a study, and makes all tests with each number of participants.
    void simulate(const stimulus_set& stimuli, const simulation& s)
    {
        if (plans.empty())
            return;
        const task& own = find_run_task(run.outline);
        std::vector<compared_person> main;
        std::vector<std::vector<std::optional<std::vector<double>>>> figures; // by factor and figure
        for (std::size_t i = 0; i < trials.size(); ++i) {
            trials[i].clear();
            for (std::size_t n = 0; n < held.front().size(); ++n) {
                std::vector<person_run>& session = people[i / most][n];
                if (session.empty())
                    continue;
                const experiment_definition& d = held[i / most][n];
                person_run& who = session[i % most];
                simulate_answers(who, {s, d, run, stimuli, who.code}, d, run, trials[i]);
            }
            if (!plans.front().figure && i >= own_from && i < own_from + most)
                main.push_back(own.compare(run.outline, trials[i]));
            std::size_t k = 0;
            for (const compared_factor& f : factors)
                for (auto& row : measure_levels(f, trials[i])) {
                    figures.resize(std::max(figures.size(), k + 1));
                    figures[k++].push_back(std::move(row));
                }
        }
        const auto test = [&](const planned_test& p, std::size_t n) {
            if (!p.figure)
                return own.test(run.outline, std::span(main).first(n),
                                fmt::format("{}/{}", s.seed, run.outline.name));
            const level_rows rows(figures[*p.figure]);
            return p.between_groups ? compare_groups(rows, most, n, p.by_level)
                                    : compare_levels(rows.subspan(own_from, n));
        };
        for (std::size_t k = 0; k < plans.size(); ++k)
            for (power_at& at : outcome.tests[k].at)
                count(at, test(plans[k], at.participants));
    }

    const run_definition& run;
    std::vector<std::string> groups; // groups that are compared, or a single group
    std::size_t most;                // participants of each group
    std::size_t own_from;            // index of the first participant in the definition's group
    std::vector<std::vector<experiment_definition>> held = {};     // by group and session
    std::vector<std::vector<std::vector<person_run>>> people = {}; // by group and session
    std::vector<std::vector<trial>> trials; // by participant, one group after the other
    std::vector<compared_factor> factors = {};
    std::vector<planned_test> plans = {}; // subjects of the tests in `outcome`
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
    std::deque<simulated_study> runs; // a deque, because it does not move its elements
    for (std::size_t run = 0; run < d.runs.size(); ++run)
        runs.emplace_back(sessions, run, r, most);
    for (std::size_t k = r.studies * (r.part - 1) / r.parts; k < r.studies * r.part / r.parts; ++k) {
        if (!go_on())
            return {};
        simulation s = r.observer;
        s.seed += k;
        for (simulated_study& one : runs)
            one.simulate(stimuli, s);
    }
    std::vector<run_power> all;
    for (simulated_study& one : runs)
        all.push_back(std::move(one.outcome));
    return all;
}

} // namespace tactor::study
