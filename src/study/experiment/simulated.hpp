// SPDX-License-Identifier: MIT
/// \file
/// Simulated observers: they answer by what a plan is predicted to feel like, and noise. They test the chain;
/// they say nothing about people.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "study/experiment/definition.hpp"
#include "study/experiment/stimuli.hpp"

namespace tactor::study {

struct simulation {
    std::uint64_t seed = 1;
    double sigma = 1.0; ///< of the noise: choose and rate in units of -ln cost, identify in mm
    double voids = 0.0; ///< share of trials that are void, as by an xrun

    friend bool operator==(const simulation&, const simulation&) = default;
};

/// "seed=1,sigma=1", or less. \throws error (bad_input).
simulation parse_simulation(std::string_view text);
std::string to_text(const simulation& s);

struct simulated_answer {
    bool is_void = false;
    unsigned response =
        0; ///< choose: 1 or 2; rate: the rating; identify: a place in the definition's motions
    unsigned response_time_ms = 0; ///< drawn for the columns' sake: a model of nothing
};

/// Of one run. Stateless: a trial's answer depends on its place and attempt alone, so that a session that
/// goes on is the one that was broken off.
class simulated_observer {
public:
    /// \throws error (bad_input) where nothing is predicted to be felt, or to move.
    simulated_observer(const simulation& s, const experiment_definition& d, const run_definition& r,
                       const stimulus_set& stimuli, std::string_view code);

    /// `practice`: a trial that does not count, which is never void.
    simulated_answer answer(const planned_trial& t, unsigned trial, unsigned attempt, bool practice) const;

private:
    double cost(std::size_t motion, std::size_t method) const;

    simulation simulation_;
    const experiment_definition& definition_;
    const run_definition& run_;
    const stimulus_set& stimuli_;
    std::string seed_;
    double mean_ = 0.0;                            ///< of -ln cost, over the cells
    std::vector<std::vector<point>> targets_ = {}; ///< identify
};

} // namespace tactor::study
