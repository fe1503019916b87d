// SPDX-License-Identifier: MIT
/// \file
/// Adaptive procedures: each answer of a track chooses the value of its next trial. Values, without a clock.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "study/experiment/definition.hpp"
#include "study/statistics/quest.hpp"

namespace tactor::study {

/// A transformed up-down staircase (Levitt 1971) on a list of values. A number of positive answers in a row
/// makes one step down, a negative one a step up; a mirrored one goes up after so many negative answers, and
/// down after a positive one. From every second reversal on the next step counts.
class value_staircase {
public:
    /// `in_row`, above 0: answers for the step that needs several. `top`: the greatest place.
    value_staircase(unsigned in_row, bool mirrored, std::vector<std::size_t> steps, std::size_t start,
                    std::size_t top)
        : needed_(in_row), mirrored_(mirrored), steps_(std::move(steps)), at_(start), top_(top)
    {
    }

    std::size_t place() const noexcept { return at_; }
    void answer(bool positive);

private:
    unsigned needed_;
    bool mirrored_;
    std::vector<std::size_t> steps_;
    std::size_t at_;
    std::size_t top_;
    unsigned in_row_ = 0;
    std::optional<bool> up_ = {};
    std::size_t reversals_ = 0;
};

/// The tracks of an adaptive run, by the answers so far.
class adaptive_tracks {
public:
    explicit adaptive_tracks(const run_definition& r) : run_(r) {}

    /// Returns the place of the value of a track's next trial. `track` is from 1.
    std::size_t next(unsigned track);
    /// Takes the answer to it.
    void answer(unsigned track, bool positive);

private:
    using procedure = std::variant<value_staircase, quest>;
    procedure& find(unsigned track);

    const run_definition& run_;
    std::map<unsigned, procedure> tracks_ = {};
};

} // namespace tactor::study
