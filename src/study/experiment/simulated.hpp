// SPDX-License-Identifier: MIT
/// \file
/// Simulated observers. They answer from a plan's predicted percept plus noise. They test the software and
/// the analysis, but do not predict the answers of people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/data/definition.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

/// Reads a text such as "seed=1,sigma=1"; missing keys keep their defaults. \throws error (bad_input).
simulation parse_simulation(std::string_view text);
std::string to_text(const simulation& s);

struct simulated_answer {
    bool is_void = false;
    trial_answer response = 0.0;   ///< value of task::simulate()
    unsigned response_time_ms = 0; ///< random; only fills the column
};

/// A simulated observer in one run. It has no state: an answer depends only on the trial's place and attempt,
/// so that a session gives the same answers after an interruption.
class simulated_observer {
public:
    simulated_observer(const simulated_observer&) = delete;
    simulated_observer& operator=(const simulated_observer&) = delete;
    /// Prepares the observer. \throws error (bad_input) if a stimulus is predicted to be silent or not to
    /// move.
    simulated_observer(const simulation& s, const experiment_definition& d, const run_definition& r,
                       const stimulus_set& stimuli, std::string_view code);

    /// Answers a trial. `practice`: true if the trial does not count; such a trial is never void.
    simulated_answer answer(const planned_trial& t, unsigned trial, unsigned attempt, bool practice) const;

private:
    simulation simulation_;
    const task& task_;
    std::string seed_;
    simulated_run run_;
};

} // namespace tactor::study
