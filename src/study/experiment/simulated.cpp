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

#include "core/split.hpp"
#include "study/analysis/measures.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

constexpr const char* simulation_shape = "write it as seed=1,sigma=1";
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
        refuse_simulation(fmt::format("{} is \"{}\", not a number from {} to {}", key, text, low, high));
    return *v;
}

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
