// SPDX-License-Identifier: MIT
#include "study/experiment/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "study/analysis/measures.hpp"
#include "study/experiment/observer_text.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

constexpr double least_cost = 1e-3;

// Returns the predicted error of a stimulus, or its unevenness in runs about uniformity.
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
                    "run it with people: only they can judge it");
    return std::max(*c, least_cost);
}

} // namespace

simulation parse_simulation(std::string_view text)
{
    simulation s;
    const auto into = [](auto& to) { return [&to](double v) { to = v; }; };
    const observer_key keys[] = {
        {"seed", 0.0, 0x1p53 - 1.0, [&](double v) { s.seed = static_cast<std::uint64_t>(v); }, true},
        {"sigma", 0.0, 1e6, into(s.sigma)},
        {"void", 0.0, 0.9, into(s.voids)},
        {"pse", -1e6, 1e6, into(s.pse)},
        {"jnd", 1e-9, 1e6, into(s.jnd)},
        {"lapse", 0.0, 0.5, into(s.lapse)},
        {"dprime", 0.0, 10.0, into(s.dprime)},
        {"exponent", 0.0, 10.0, into(s.exponent)}};
    read_observer(text, keys, "seed=1,sigma=1");
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
      task_(task_in(r.outline)),
      seed_(fmt::format("{}/{}", session_seed(s.seed, d, code), r.outline.name)),
      run_{simulation_, d, r,
           [&d, &r, &stimuli](std::size_t motion, std::size_t method) {
               return find_cost(d, r, stimuli, motion, method);
           },
           [&stimuli](std::size_t motion, std::size_t method) -> const std::vector<std::vector<point>>& {
               return stimuli.at(motion, method).felt_paths;
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

} // namespace tactor::study
