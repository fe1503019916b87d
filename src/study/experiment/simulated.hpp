// SPDX-License-Identifier: MIT
/// \file
/// Simulated observers, who answer by the predicted percept of a plan and noise. They test the chain; they
/// say nothing about people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/experiment/definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
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

} // namespace tactor::study
