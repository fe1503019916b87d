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
#include "study/experiment/adaptive.hpp"
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

double mean_distance(const std::vector<point>& a, const std::vector<point>& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::hypot(b[i].x_mm - a[i].x_mm, b[i].y_mm - a[i].y_mm);
    return sum / static_cast<double>(a.size());
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
            one.signal = r.outline.task == task_kind::same_different ? t.method_1 != t.method_2
                                                                     : !d.methods[t.method_1].silent;
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
    adaptive_tracks tracks(r);
    for (std::size_t i = 0; i < p.trials.size(); ++i) {
        planned_trial& t = p.planned[i];
        if (t.track > 0)
            set_value(t, r, tracks.next(t.track));
        simulated_answer a;
        unsigned attempt = 0;
        do
            a = who.answer(t, p.trials[i].place, ++attempt, false);
        while (a.is_void);
        p.trials[i].value = find_value(d, t).value_or(0.0);
        const auto answer = static_cast<unsigned>(a.response);
        p.trials[i].positive = is_positive(r.outline, d.methods[t.method_1].name, answer);
        if (t.track > 0)
            tracks.answer(t.track, p.trials[i].positive);
        p.trials[i].response = r.outline.task == task_kind::identify
                                   ? static_cast<unsigned>(place_in(r.motions, answer))
                                   : answer;
        p.trials[i].estimate = a.response;
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
      definition_(d),
      run_(r),
      stimuli_(stimuli),
      seed_(fmt::format("{}/{}", session_seed(s.seed, d, code), r.outline.name))
{
    if (r.outline.task == task_kind::identify) {
        for (const std::size_t m : r.motions)
            targets_.push_back(target_path(d.motions[m].drawn));
        return;
    }
    if (find_task(r.outline.task).about().measures)
        return;
    if (r.simulate_as.empty())
        throw error(error_kind::bad_input, r.where,
                    fmt::format("simulate: the observer cannot judge \"{}\"", r.attribute),
                    "add simulate_as = \"similarity\" or \"uniformity\"");
    double sum = 0.0;
    for (const std::size_t motion : r.motions)
        for (const std::size_t method : r.methods)
            sum -= std::log(cost(motion, method));
    mean_ = sum / static_cast<double>(r.motions.size() * r.methods.size());
}

double simulated_observer::cost(std::size_t motion, std::size_t method) const
{
    const percept_summary& felt = stimuli_.at(motion, method).felt;
    const std::optional<double> c = run_.simulate_as == "uniformity" ? felt.speed_cv : felt.rms_error_mm;
    if (!c)
        throw error(error_kind::bad_input, definition_.motions[motion].where,
                    fmt::format("simulate: the prediction for motion \"{}\" with method \"{}\" {}",
                                definition_.motions[motion].name, definition_.methods[method].name,
                                run_.simulate_as == "uniformity" ? "does not move" : "is silent"),
                    "people can judge it; the simulated observer cannot");
    return std::max(*c, least_cost);
}

bool simulated_observer::feels_more(double value, random_numbers& r) const
{
    const run_outline& o = run_.outline;
    const auto [least, greatest] = std::pair(o.values.front(), o.values.back());
    const double pse = simulation_.pse.value_or(o.standard.value_or(0.5 * (least + greatest)));
    const double jnd = simulation_.jnd.value_or(0.1 * (greatest - least));
    return r.unit() < normal_chance(value, {pse, jnd / normal_quartile, 0.0}, 0.0);
}

double simulated_observer::measure(const planned_trial& t, random_numbers& r) const
{
    const run_outline& o = run_.outline;
    const std::optional<double> value = find_value(definition_, t);
    if (o.task == task_kind::estimate) {
        constexpr double modulus = 100.0; // of the standard, or of the middle value
        const double middle = o.standard.value_or(o.values[o.values.size() / 2]);
        const double ratio = size_ratio(o, *value, middle);
        const double number =
            modulus * std::pow(ratio, simulation_.exponent) * std::exp(simulation_.sigma * r.normal());
        const auto rounded = detail::number_in<double>(fmt::format("{:.3g}", number));
        return std::clamp(rounded.value_or(number), least_estimate, most_estimate);
    }
    if (simulation_.lapse > 0.0 && r.unit() < simulation_.lapse)
        return 1 + r.below(2);
    if (o.task == task_kind::same_different) {
        // Differs if what is felt is further apart than this, in units of d'.
        constexpr double criterion = std::numbers::sqrt2;
        const double apart = t.method_1 != *t.method_2 ? simulation_.dprime : 0.0;
        return std::abs(apart + r.normal() - r.normal()) > criterion ? 2 : 1;
    }
    if (o.task == task_kind::detect) {
        if (definition_.methods[t.method_1].silent && !o.vary.empty())
            return 2;
        if (value)
            return feels_more(*value, r) ? 1 : 2;
        const double felt = definition_.methods[t.method_1].silent ? 0.0 : simulation_.dprime;
        return felt + r.normal() > 0.5 * simulation_.dprime ? 1 : 2;
    }
    const bool more = feels_more(*value, r);
    const bool standard_first = definition_.methods[t.method_1].name == standard_name;
    return more == (!t.method_2 || standard_first) ? 2 : 1;
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
    const auto noise = [&] { return simulation_.sigma * r.normal(); };
    const auto utility = [&](std::size_t method) { return -std::log(cost(t.motion, method)) + noise(); };
    if (find_task(run_.outline.task).about().measures) {
        a.response = measure(t, r);
    } else if (run_.outline.task == task_kind::choose) {
        const double first = utility(t.method_1);
        a.response = first >= utility(t.method_2.value()) ? 1 : 2;
    } else if (run_.outline.task == task_kind::rate) {
        const double lowest = run_.outline.lowest_rating();
        const double highest = run_.outline.scale;
        const double rating = std::round((highest + lowest) / 2.0 + utility(t.method_1) - mean_);
        a.response = std::clamp(rating, lowest, highest);
    } else { // identify
        std::vector<point> felt = stimuli_.at(t.motion, t.method_1).felt_path;
        for (point& p : felt) {
            p.x_mm += noise();
            p.y_mm += noise();
        }
        std::vector<double> distances;
        for (const std::vector<point>& target : targets_)
            distances.push_back(mean_distance(target, felt));
        const auto nearest = std::ranges::min_element(distances) - distances.begin();
        a.response = static_cast<double>(run_.motions[static_cast<std::size_t>(nearest)]);
    }
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
