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
    std::optional<std::uint64_t> seed = {}; ///< seed of the orders; default: as in a session
    std::size_t part = 1;                   ///< number of the part to simulate, from 1
    std::size_t parts = 1;                  ///< number of parts that divide the studies in order
};

/// Level of significance: a smaller p is significant.
inline constexpr double significant_p = 0.05;

/// Outcomes of studies with one number of participants.
struct power_at {
    std::size_t participants = 0;
    std::size_t significant = 0; ///< studies with p < 0.05, two-sided
    std::size_t for_last = 0;    ///< number of these in which the mean was larger, or the last level's mean
    std::size_t untested = 0;    ///< studies without a test, because all participants are equal
};

/// A test that analyze prints: the main comparison of a run, or of a figure between the levels of a factor.
struct tested_power {
    std::string factor = {};              ///< method, session, group or group:method; empty: main comparison
    std::string figure = {};              ///< "jnd"; empty for the main comparison
    std::vector<std::string> levels = {}; ///< names of the factor's levels
    std::vector<power_at> at = {};        ///< outcomes by sample size
};

struct run_power {
    std::size_t run = 0; ///< index in the definition
    /// The main comparison comes first, except for a run that compares nothing by itself.
    std::vector<tested_power> tests = {};
};

/// Simulates and tests each study of the part: two levels by a paired t test, more levels and groups by the
/// analysis of variance with the correction of Greenhouse and Geisser. Other groups that do a run as the
/// group of `d` does have as many participants, and the same stimuli. Study k (from 0) has the participants
/// 01, 02, ..., each with all sessions and an observer whose seed is that of `observer` plus k. A study of n
/// consists of the first n participants of a larger one. Void trials come again. Calls `go_on` before each
/// study, and returns nothing if `go_on` returns false. \throws error (bad_input) as simulated_observer does.
std::optional<std::vector<run_power>> simulate_power(const experiment_definition& d,
                                                     const stimulus_set& stimuli, const power_request& r,
                                                     const std::function<bool()>& go_on);

} // namespace tactor::study
