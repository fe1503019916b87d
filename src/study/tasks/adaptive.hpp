// SPDX-License-Identifier: MIT
/// \file
/// Adaptive procedures: each answer in a track determines the value of the track's next trial.
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "study/experiment/definition.hpp"
#include "study/statistics/quest.hpp"
#include "study/statistics/up_down.hpp"

namespace tactor::study {

/// A staircase on a list of values.
class value_staircase {
public:
    /// Starts at `start`. `in_row`: number of answers in a row for a step, above 0. `top`: greatest index of
    /// a value.
    value_staircase(unsigned in_row, bool mirrored, std::vector<std::size_t> steps, std::size_t start,
                    std::size_t top)
        : rule_({.in_row = in_row, .sizes = steps.size(), .mirrored = mirrored}),
          steps_(std::move(steps)),
          at_(start),
          top_(top)
    {
    }

    std::size_t place() const noexcept { return at_; }
    void answer(bool positive);

private:
    up_down_rule rule_;
    std::vector<std::size_t> steps_;
    std::size_t at_;
    std::size_t top_;
};

/// The tracks of an adaptive run, with the answers so far.
class adaptive_tracks {
public:
    explicit adaptive_tracks(const run_definition& r) : run_(r) {}

    /// Returns the index of the value for a track's next trial. `track` counts from 1.
    std::size_t next(unsigned track);
    /// Takes the answer to the trial of next().
    void answer(unsigned track, bool positive);

private:
    using procedure = std::variant<value_staircase, quest>;
    procedure& find(unsigned track);

    const run_definition& run_;
    std::map<unsigned, procedure> tracks_ = {};
};

} // namespace tactor::study
