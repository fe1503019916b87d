// SPDX-License-Identifier: MIT
/// \file
/// Simulated observers, who answer by the predicted percept of a plan and noise, and the power of studies
/// with them. They test the chain; they say nothing about people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/experiment/definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

struct simulation {
    std::uint64_t seed = 1;
    double sigma = 1.0; ///< of the noise: choose and rate in units of -ln cost, identify in mm
    double voids = 0.0; ///< share of trials that are void, as by an xrun
    // Truth of tasks that measure.
    std::optional<double> pse = {}; ///< value with an even chance; none: the standard, or the middle value
    std::optional<double> jnd = {}; ///< half the distance from 25 to 75 %; none: a tenth of the values' range
    double lapse = 0.0;             ///< share of trials in which either key is pressed, each as often
    double dprime = 1.0;
    double exponent = 1.0; ///< of the estimates; sigma is the noise of their logarithm

    friend bool operator==(const simulation&, const simulation&) = default;
};

/// Reads "seed=1,sigma=1", or less. \throws error (bad_input).
simulation parse_simulation(std::string_view text);
std::string to_text(const simulation& s);

struct simulated_answer {
    bool is_void = false;
    double response = 0.0;         ///< as task::simulate() returns it
    unsigned response_time_ms = 0; ///< drawn to fill the column: no model of people
};

/// An observer in one run. Stateless: a trial's answer depends on its place and attempt alone, so that a
/// session that goes on is the one that was broken off.
class simulated_observer {
public:
    simulated_observer(const simulated_observer&) = delete;
    simulated_observer& operator=(const simulated_observer&) = delete;
    /// \throws error (bad_input) if a stimulus is predicted not to be felt, or not to move.
    simulated_observer(const simulation& s, const experiment_definition& d, const run_definition& r,
                       const stimulus_set& stimuli, std::string_view code);

    /// `practice`: a trial that does not count, which is never void.
    simulated_answer answer(const planned_trial& t, unsigned trial, unsigned attempt, bool practice) const;

private:
    simulation simulation_;
    const task& task_;
    std::string seed_;
    simulated_run run_;
};

struct power_request {
    simulation observer = {};
    std::vector<std::size_t> participants = {}; ///< sample sizes to simulate, each at least 2
    std::size_t studies = 200;
    std::optional<std::uint64_t> seed = {}; ///< of the orders; none: the definition's, or the codes'
    std::size_t part = 1;                   ///< from 1
    std::size_t parts = 1;                  ///< into which the studies are divided, in their order
};

/// Level of significance: a smaller p is significant.
inline constexpr double significant_p = 0.05;

/// Outcomes of studies with so many participants.
struct power_at {
    std::size_t participants = 0;
    std::size_t significant = 0; ///< studies with p < 0.05, two-sided
    std::size_t for_last = 0;    ///< of these, those in which the last method was better
    std::size_t untested = 0;    ///< without a test: nobody differed from anybody
};

struct run_power {
    std::size_t run = 0; ///< index in the definition
    /// By sample size; empty for ratings of one method, where there is nothing to compare.
    std::vector<power_at> at = {};
};

/// Simulates the studies of the part and tests each. Study k (from 0) has the participants 01, 02, ... whose
/// observers have the seed of `observer` plus k, and hold all sessions. A study of n has the first n
/// participants of a larger one. Void trials come again. Calls `go_on` before each study, and returns nothing
/// if it returns false. \throws error (bad_input) as simulated_observer does.
std::optional<std::vector<run_power>> simulate_power(const experiment_definition& d,
                                                     const stimulus_set& stimuli, const power_request& r,
                                                     const std::function<bool()>& go_on);

} // namespace tactor::study
