// SPDX-License-Identifier: MIT
#include "study/experiment/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "study/experiment/observer_text.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/results/measures.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

constexpr double least_cost = 1e-3;

// Returns the predicted error of a stimulus, mm. In runs about uniformity, returns the predicted coefficient
// of variation of the stimulus's speed. Throws error (bad_input) if there is no such prediction.
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
                    "ask people instead of simulating this run");
    return std::max(*c, least_cost);
}

} // namespace

simulation parse_simulation(std::string_view text)
{
    simulation s;
    const auto into = [](double& to) { return [&to](double v) { to = v; }; };
    // The first value replaces the default. Each further value is for the next method.
    const auto list = [](std::vector<double>& to) {
        return [&to, is_new = true](double v) mutable {
            if (std::exchange(is_new, false))
                to.clear();
            to.push_back(v);
        };
    };
    const observer_key keys[] = {
        {"seed", 0.0, 0x1p53 - 1.0, [&](double v) { s.seed = static_cast<std::uint64_t>(v); }, true},
        {"sigma", 0.0, 1e6, into(s.sigma)},
        {"void", 0.0, 0.9, into(s.voids)},
        {"pse", -1e6, 1e6, list(s.pse), false, true},
        {"jnd", 1e-9, 1e6, list(s.jnd), false, true},
        {"lapse", 0.0, 0.5, into(s.lapse)},
        {"dprime", 0.0, 10.0, list(s.dprime), false, true},
        {"exponent", 0.0, 10.0, list(s.exponent), false, true},
        {"pse_sd", 0.0, 1e6, into(s.pse_sd)},
        {"jnd_sd", 0.0, 1e6, into(s.jnd_sd)},
        {"dprime_sd", 0.0, 10.0, into(s.dprime_sd)},
        {"exponent_sd", 0.0, 10.0, into(s.exponent_sd)},
        {"correlation", 0.0, 1.0, into(s.correlation)},
        {"group_d", -10.0, 10.0, into(s.group_d)},
        {"method_sd", 0.0, 1e6, into(s.method_sd)}};
    read_observer(text, keys, "seed=1,sigma=1");
    return s;
}

std::string to_text(const simulation& s)
{
    const simulation usual;
    std::string text = fmt::format("seed={},sigma={}", s.seed, s.sigma);
    const auto add = [&text](std::string_view key, const auto& v, const auto& other) {
        if (v == other)
            return;
        if constexpr (std::is_same_v<decltype(v), const double&>)
            text += fmt::format(",{}={}", key, v);
        else
            text += fmt::format(",{}={}", key, fmt::join(v, ","));
    };
    add("void", s.voids, usual.voids);
    add("lapse", s.lapse, usual.lapse);
    add("dprime", s.dprime, usual.dprime);
    add("exponent", s.exponent, usual.exponent);
    add("pse", s.pse, usual.pse);
    add("jnd", s.jnd, usual.jnd);
    add("pse_sd", s.pse_sd, usual.pse_sd);
    add("jnd_sd", s.jnd_sd, usual.jnd_sd);
    add("dprime_sd", s.dprime_sd, usual.dprime_sd);
    add("exponent_sd", s.exponent_sd, usual.exponent_sd);
    add("correlation", s.correlation, usual.correlation);
    add("group_d", s.group_d, usual.group_d);
    add("method_sd", s.method_sd, usual.method_sd);
    return text;
}

simulated_observer::simulated_observer(const simulation& s, const experiment_definition& d,
                                       const run_definition& r, const stimulus_set& stimuli,
                                       std::string_view code)
    : simulation_(s),
      task_(find_run_task(r.outline)),
      seed_(fmt::format("{}/{}", session_seed(s.seed, d, code), r.outline.name)),
      run_{simulation_, d, r,
           [&d, &r, &stimuli](std::size_t motion, std::size_t method) {
               return find_cost(d, r, stimuli, motion, method);
           },
           [&stimuli](std::size_t motion, std::size_t method) -> const std::vector<std::vector<point>>& {
               return stimuli.at(motion, method).felt_paths;
           }}
{
    for (const auto& [key, values] :
         {std::pair("pse", &s.pse), {"jnd", &s.jnd}, {"dprime", &s.dprime}, {"exponent", &s.exponent}})
        if (values->size() > 1 && r.methods.size() > 1 && values->size() != r.methods.size())
            throw error(error_kind::bad_input, r.where,
                        fmt::format("simulate: {} has {} values, but run \"{}\" has {} methods", key,
                                    values->size(), r.outline.name, r.methods.size()),
                        "give one value, or one for each method");
    // The seed leaves out run and session, so that a person is the same in all runs and sessions.
    random_numbers numbers(fmt::format("{}/{}/{}/person", s.seed, d.outline.name, code));
    const auto draw = [&numbers] {
        simulated_figures one;
        for (double* own : {&one.pse, &one.jnd, &one.dprime, &one.exponent})
            *own = numbers.normal();
        return one;
    };
    run_.person.figures = draw();
    if (const auto& groups = d.outline.groups; groups.size() > 1)
        run_.person.group =
            s.group_d *
            static_cast<double>(std::ranges::find(groups, d.group, &group_outline::name) - groups.begin()) /
            static_cast<double>(groups.size() - 1);
    for (std::size_t m = 0; m < d.methods.size(); ++m)
        run_.person.methods.push_back(numbers.normal());
    for (std::size_t m = 0; m < d.methods.size(); ++m)
        run_.person.figures_by_method.push_back(draw());
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

} // namespace tactor::study
