// SPDX-License-Identifier: MIT
/// \file
/// The order of a participant's runs, and of the trials in each: the same on every machine.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "study/experiment/definition.hpp"

namespace tactor::study {

/// Motion and methods are places in those of the definition.
struct planned_trial {
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::optional<std::size_t> method_2 = {}; ///< of choose only
    double rest_s = 0.0;                      ///< pause before it

    friend bool operator==(const planned_trial&, const planned_trial&) = default;
};

struct run_sequence {
    std::size_t run = 0;                      ///< its place in the definition
    std::vector<planned_trial> practice = {}; ///< before the others, which count
    std::vector<planned_trial> trials = {};   ///< trial 1 is the first

    friend bool operator==(const run_sequence&, const run_sequence&) = default;
};

/// Most trials with the same motion in a row.
inline constexpr std::size_t most_in_a_row = 3;

/// Returns how many orders of so many trials make_run() draws before it gives up: a second or two.
constexpr std::size_t most_draws(std::size_t trials) noexcept
{
    return std::min(std::size_t{1000000}, std::size_t{200000000} / std::max(trials, std::size_t{1}));
}

/// Returns the seed for a participant without one: the first four bytes of the code's SHA-256.
std::uint64_t default_seed(std::string_view code);

/// Returns the order of n runs: a row of the Williams square (two of them for an odd n), in which each run
/// follows each other equally often. The row is the number at the code's end less 1, or without a number
/// default_seed(), modulo the number of rows.
std::vector<std::size_t> run_order(std::size_t n, std::string_view code);

/// Draws the trials of one run, from the generator that "seed/experiment/code/run" seeds.
/// \throws error (bad_input) if every order drawn has a motion four times in a row.
run_sequence make_run(const experiment_definition& d, std::size_t run, std::string_view code,
                      std::uint64_t seed);

/// Draws all runs, in the participant's order. Throws as above.
std::vector<run_sequence> make_sequence(const experiment_definition& d, std::string_view code,
                                        std::uint64_t seed);

} // namespace tactor::study
