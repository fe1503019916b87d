// SPDX-License-Identifier: MIT
/// \file
/// The power of studies with simulated observers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/experiment/simulated.hpp"

namespace tactor::study {

struct power_request {
    simulation observer = {};
    std::vector<std::size_t> participants = {}; ///< sample sizes to simulate, each at least 2
    std::size_t studies = 200;
    std::optional<std::uint64_t> seed = {}; ///< seed of the trial orders; if missing, as in a session
    std::size_t part = 1;                   ///< number of the part to simulate, from 1
    std::size_t parts = 1;                  ///< number of parts into which the studies are divided, in order
};

/// Level of significance: a smaller p is significant.
inline constexpr double significant_p = 0.05;

/// Outcomes of the studies with a certain number of participants.
struct power_at {
    std::size_t participants = 0;
    std::size_t significant = 0; ///< studies with p < 0.05, two-sided
    std::size_t for_last = 0;    ///< significant studies in which the (last level's) mean was larger
    std::size_t untested = 0;    ///< studies without a test, because all participants are equal
};

/// A test that analyze prints: the main comparison of a run, or the comparison of a figure between the levels
/// of a factor.
struct tested_power {
    std::string factor = {}; ///< method, session, group or group:method; empty for the main comparison
    std::string figure = {}; ///< such as "jnd"; empty for the main comparison
    std::vector<std::string> levels = {}; ///< names of the factor's levels
    std::vector<power_at> at = {};        ///< outcomes by sample size
};

struct run_power {
    std::size_t run = 0; ///< index in the definition
    /// Tests of the run. The main comparison comes first, if the task has one.
    std::vector<tested_power> tests = {};
};

/// Simulates and tests each study of the part. Compares two levels by a paired t test, and more levels or
/// groups by the analysis of variance with the Greenhouse-Geisser correction. Other groups that do the same
/// run have as many participants as the group of `d`, and the same stimuli. Study k (from 0) has the
/// participants 01, 02, ..., who do all sessions; the seed of its observers is the seed of `observer` plus k.
/// A study of n participants consists of the first n participants of a larger study. Repeats void trials.
/// Calls `go_on` before each study, and returns nothing if `go_on` returns false. \throws error (bad_input)
/// as simulated_observer does.
std::optional<std::vector<run_power>> simulate_power(const experiment_definition& d,
                                                     const stimulus_set& stimuli, const power_request& r,
                                                     const std::function<bool()>& go_on);

} // namespace tactor::study
