// SPDX-License-Identifier: MIT
#include "study/experiment/power.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "study/analysis/analysis.hpp"
#include "study/experiment/sequence.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

// A participant's trials of a run: as planned, and as the analysis has them but for the answers.
struct prepared_run {
    std::vector<planned_trial> planned = {};
    std::vector<trial> trials = {};
};

struct prepared_person {
    std::string code;
    std::vector<prepared_run> runs = {}; ///< by place in the definition
};

std::size_t place_in(const std::vector<std::size_t>& places, std::size_t of)
{
    return static_cast<std::size_t>(std::find(places.begin(), places.end(), of) - places.begin());
}

prepared_run prepare_run(const experiment_definition& d, std::size_t run, const std::string& code,
                         std::uint64_t seed)
{
    const run_definition& r = d.runs[run];
    prepared_run p;
    p.planned = make_run(d, run, code, seed).trials;
    for (const planned_trial& t : p.planned) {
        trial one;
        one.place = static_cast<unsigned>(p.trials.size() + 1);
        one.motion = place_in(r.motions, t.motion);
        one.method_1 = place_in(r.methods, t.method_1);
        if (t.method_2)
            one.method_2 = place_in(r.methods, *t.method_2);
        p.trials.push_back(one);
    }
    return p;
}

std::vector<prepared_person> prepare_people(const experiment_definition& d, std::size_t n,
                                            const std::optional<std::uint64_t>& asked)
{
    std::vector<prepared_person> all;
    for (std::size_t i = 1; i <= n; ++i) {
        prepared_person p{fmt::format("{:02}", i), {}};
        const std::uint64_t seed = asked.value_or(d.seed.value_or(seed_of(p.code)));
        for (std::size_t run = 0; run < d.runs.size(); ++run)
            p.runs.push_back(prepare_run(d, run, p.code, seed));
        all.push_back(std::move(p));
    }
    return all;
}

// Fills the answers in; a trial that is void comes again until it is not.
void answer_all(prepared_run& p, const simulated_observer& who, const run_definition& r)
{
    for (std::size_t i = 0; i < p.trials.size(); ++i) {
        simulated_answer a;
        unsigned attempt = 0;
        do
            a = who.answer(p.planned[i], p.trials[i].place, ++attempt, false);
        while (a.is_void);
        p.trials[i].response = r.outline.task == task_kind::identify
                                   ? static_cast<unsigned>(place_in(r.motions, a.response))
                                   : a.response;
    }
}

// `values` by participant; who has none lacks a cell, and is left out as in the analysis.
void count_study(power_at& at, const std::vector<std::optional<double>>& values, const run_outline& run)
{
    std::vector<double> there;
    for (std::size_t i = 0; i < at.participants; ++i)
        if (values[i])
            there.push_back(*values[i]);
    const t_test t = quick_test_mean(there, chance(run), rounding_in(run));
    if (!t.p)
        ++at.untested;
    else if (*t.p < significant_p) {
        ++at.significant;
        at.for_last += *t.t > 0.0 ? 1 : 0;
    }
}

} // namespace

std::optional<std::vector<run_power>> simulate_power(const experiment_definition& d,
                                                     const stimulus_set& stimuli, const power_request& r,
                                                     const std::function<bool()>& go_on)
{
    std::vector<prepared_person> people =
        prepare_people(d, *std::max_element(r.participants.begin(), r.participants.end()), r.seed);
    std::vector<run_power> all;
    for (std::size_t run = 0; run < d.runs.size(); ++run) {
        all.push_back({run, {}});
        if (d.runs[run].outline.task != task_kind::rate || d.runs[run].methods.size() > 1)
            for (const std::size_t n : r.participants)
                all[run].at.push_back({n});
    }
    for (std::size_t k = 0; k < r.studies; ++k) {
        if (!go_on())
            return {};
        simulation s = r.observer;
        s.seed += k;
        for (run_power& p : all) {
            if (p.at.empty())
                continue;
            const run_definition& run = d.runs[p.run];
            std::vector<std::optional<double>> values;
            for (prepared_person& who : people) {
                answer_all(who.runs[p.run], {s, d, run, stimuli, who.code}, run);
                const auto cells = compute_cells(run.outline, who.runs[p.run].trials);
                values.push_back(cells ? compared_value(run.outline, *cells) : std::nullopt);
            }
            for (power_at& at : p.at)
                count_study(at, values, run.outline);
        }
    }
    for (run_power& p : all)
        for (power_at& at : p.at) {
            at.power = static_cast<double>(at.significant) / static_cast<double>(r.studies);
            at.ci = binomial_interval(at.significant, r.studies);
        }
    return all;
}

} // namespace tactor::study
