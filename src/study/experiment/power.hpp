// SPDX-License-Identifier: MIT
/// \file
/// How often simulated studies find what an experiment looks for. Says what a design can do where the model
/// is right, and nothing about people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "study/experiment/simulated.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {

struct power_request {
    simulation observer = {};
    std::vector<std::size_t> participants = {}; ///< numbers of them, each 2 or more
    std::size_t studies = 200;
    std::optional<std::uint64_t> seed = {}; ///< of the orders; none: the definition's, or the codes'
};

/// p below this is significant.
inline constexpr double significant_p = 0.05;

/// Of studies with so many participants.
struct power_at {
    std::size_t participants = 0;
    std::size_t significant = 0; ///< studies with p < 0.05, two-sided
    std::size_t for_last = 0;    ///< of these, those in which the last method was better
    std::size_t untested = 0;    ///< without a test: nobody differed from anybody
    double power = 0.0;          ///< significant, of all studies
    interval ci = {};            ///< of it, binomial
};

struct run_power {
    std::size_t run = 0; ///< its place in the definition
    /// In the order asked for; empty where there is nothing to compare: ratings of one method.
    std::vector<power_at> at = {};
};

/// Study k (from 0) is that of the participants 01, 02, ... whose observers have the seed of `observer` plus
/// k. A study of n is the first n participants of that of more. Void trials come again. `go_on` is asked
/// before each study; nothing is returned where it says false.
/// \throws error (bad_input) as simulated_observer and make_run() do.
std::optional<std::vector<run_power>> simulate_power(const experiment_definition& d,
                                                     const stimulus_set& stimuli, const power_request& r,
                                                     const std::function<bool()>& go_on);

} // namespace tactor::study
