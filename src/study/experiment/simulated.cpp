// SPDX-License-Identifier: MIT
#include "study/experiment/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "study/analysis/analysis.hpp"
#include "study/analysis/measures.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

constexpr const char* simulation_shape = "as seed=1,sigma=1";
constexpr double least_cost = 1e-3;

[[noreturn]] void refuse_simulation(const std::string& why)
{
    throw error(error_kind::bad_input, "--simulate", why, simulation_shape);
}

template <class T>
T simulation_value(std::string_view key, std::string_view text, T low, T high)
{
    const auto v = detail::number_in<T>(text);
    if (!v || !(*v >= low && *v <= high))
        refuse_simulation(fmt::format("{} is \"{}\", not {} to {}", key, text, low, high));
    return *v;
}

// A participant's trials of a run: as planned, and as the analysis has them.
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

// Fills the answers in; a trial that is void comes again until it is not.
void answer_all(person_run& p, const simulated_observer& who, const experiment_definition& d,
                const run_definition& r)
{
    const task& own = find_task(r.outline.task);
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
        const std::string& method_1 = d.methods[t.method_1].name;
        own.score(p.trials[i], r.outline, method_1, a.response);
        values->take(t.track, method_1, static_cast<unsigned>(a.response));
    }
}

// A participant in the main comparison of a run.
struct compared_person {
    std::optional<double> value = {};
    std::optional<difference_counts> counts = {}; ///< same-different
};

compared_person compare_trials(const run_outline& run, const std::vector<trial>& trials)
{
    if (!find_task(run.task).about().measures) {
        const auto cells = compute_cells(run, trials);
        return {cells ? compared_value(run, *cells) : std::nullopt};
    }
    const person_measures m = measure_trials(run, trials, sigmoid::normal, "");
    compared_person p{list_measures(run, m).front().second};
    if (run.task == task_kind::same_different && m.detected)
        p.counts = m.detected->counts;
    return p;
}

// Tests one study by its first participants. One without a value lacks a cell and is left out, as in the
// analysis.
void count_study(power_at& at, const std::vector<compared_person>& people, const run_outline& run,
                 std::string_view seed)
{
    std::vector<double> there;
    std::vector<difference_counts> counts;
    for (const compared_person& p : std::span(people).first(at.participants)) {
        if (p.value)
            there.push_back(*p.value);
        if (p.counts)
            counts.push_back(*p.counts);
    }
    if (run.task == task_kind::same_different) {
        const auto difference = test_difference(counts, seed);
        const std::size_t found = difference && difference->p < significant_p ? 1 : 0;
        at.significant += found;
        at.for_last += found;
        at.untested += difference ? 0 : 1;
        return;
    }
    const double against =
        find_task(run.task).about().measures ? measured_against(run).value_or(0.0) : chance(run);
    const t_test t = quick_test_mean(there, against, rounding_in(run));
    if (!t.p)
        ++at.untested;
    else if (*t.p < significant_p) {
        ++at.significant;
        at.for_last += *t.t > 0.0 ? 1 : 0;
    }
}

// Returns the predicted error of a stimulus, or how uneven it is.
double find_cost(const experiment_definition& d, const run_definition& r, const stimulus_set& stimuli,
                 std::size_t motion, std::size_t method)
{
    const percept_summary& felt = stimuli.at(motion, method).felt;
    const std::optional<double> c = r.simulate_as == "uniformity" ? felt.speed_cv : felt.rms_error_mm;
    if (!c)
        throw error(error_kind::bad_input, d.motions[motion].where,
                    fmt::format("simulate: the prediction for motion \"{}\" with method \"{}\" {}",
                                d.motions[motion].name, d.methods[method].name,
                                r.simulate_as == "uniformity" ? "does not move" : "is silent"),
                    "people can judge it; the simulated observer cannot");
    return std::max(*c, least_cost);
}

} // namespace

simulation parse_simulation(std::string_view text)
{
    constexpr std::uint64_t most_seed = (std::uint64_t{1} << 53) - 1;
    simulation s;
    std::vector<std::string_view> seen;
    for (const std::string_view item : detail::split(text, ',')) {
        const std::size_t equals = std::min(item.find('='), item.size());
        const std::string_view key = item.substr(0, equals);
        const std::string_view value = equals < item.size() ? item.substr(equals + 1) : std::string_view{};
        if (std::find(seen.begin(), seen.end(), key) != seen.end())
            refuse_simulation(fmt::format("{} occurs twice", key));
        seen.push_back(key);
        if (key == "seed")
            s.seed = simulation_value<std::uint64_t>(key, value, 0, most_seed);
        else if (key == "sigma")
            s.sigma = simulation_value(key, value, 0.0, 1e6);
        else if (key == "void")
            s.voids = simulation_value(key, value, 0.0, 0.9);
        else if (key == "pse")
            s.pse = simulation_value(key, value, -1e6, 1e6);
        else if (key == "jnd")
            s.jnd = simulation_value(key, value, 1e-9, 1e6);
        else if (key == "lapse")
            s.lapse = simulation_value(key, value, 0.0, 0.5);
        else if (key == "dprime")
            s.dprime = simulation_value(key, value, 0.0, 10.0);
        else if (key == "exponent")
            s.exponent = simulation_value(key, value, 0.0, 10.0);
        else
            refuse_simulation(fmt::format("\"{}\" is unknown", key));
    }
    return s;
}

std::string to_text(const simulation& s)
{
    const simulation usual;
    std::string text = fmt::format("seed={},sigma={}", s.seed, s.sigma);
    for (const auto& [key, v, other] : {std::tuple("void", s.voids, usual.voids),
                                        {"lapse", s.lapse, usual.lapse},
                                        {"dprime", s.dprime, usual.dprime},
                                        {"exponent", s.exponent, usual.exponent}})
        if (v != other)
            text += fmt::format(",{}={}", key, v);
    for (const auto& [key, v] : {std::pair("pse", s.pse), {"jnd", s.jnd}})
        if (v)
            text += fmt::format(",{}={}", key, *v);
    return text;
}

simulated_observer::simulated_observer(const simulation& s, const experiment_definition& d,
                                       const run_definition& r, const stimulus_set& stimuli,
                                       std::string_view code)
    : simulation_(s),
      task_(find_task(r.outline.task)),
      seed_(fmt::format("{}/{}", session_seed(s.seed, d, code), r.outline.name)),
      run_{simulation_, d, r,
           [&d, &r, &stimuli](std::size_t motion, std::size_t method) {
               return find_cost(d, r, stimuli, motion, method);
           },
           [&stimuli](std::size_t motion, std::size_t method) -> const std::vector<point>& {
               return stimuli.at(motion, method).felt_path;
           }}
{
    task_.prepare(run_);
}

simulated_answer simulated_observer::answer(const planned_trial& t, unsigned trial, unsigned attempt,
                                            bool practice) const
{
    random_numbers r(fmt::format("{}/{}/{}/{}", seed_, practice ? "practice" : "trial", trial, attempt));
    simulated_answer a;
    a.is_void = r.unit() < simulation_.voids && !practice;
    constexpr unsigned soonest_ms = 400;
    constexpr unsigned range_ms = 1200;
    a.response_time_ms = soonest_ms + r.below(range_ms);
    a.response = task_.simulate(run_, t, r);
    return a;
}

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
        if (find_task(o.task).about().measures ? measured_against(o).has_value()
                                               : o.task != task_kind::rate || o.methods.size() > 1)
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
            std::vector<compared_person> compared;
            for (std::size_t i = 0; i < most; ++i) {
                std::vector<trial> trials;
                for (std::size_t n = 0; n < sessions.size(); ++n) {
                    person_run& who = people[p.run][n][i];
                    answer_all(who, {s, sessions[n], run, stimuli, who.code}, d, run);
                    trials.insert(trials.end(), who.trials.begin(), who.trials.end());
                }
                compared.push_back(compare_trials(run.outline, trials));
            }
            for (power_at& at : p.at)
                count_study(at, compared, run.outline, fmt::format("{}/{}", s.seed, run.outline.name));
        }
    }
    return all;
}

} // namespace tactor::study
