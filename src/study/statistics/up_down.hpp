// SPDX-License-Identifier: MIT
/// \file
/// The transformed up-down rule of adaptive procedures (Levitt 1971), in levels or in places of a list.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

namespace tactor::study {

/// A rule for steps: several positive answers in a row make one step down, and one negative answer makes one
/// step up. Every second reversal moves on to the next step size. The owner moves the level.
class up_down_rule {
public:
    struct options {
        unsigned in_row = 1;   ///< number of answers in a row for a step, above 0
        std::size_t sizes = 1; ///< number of step sizes, above 0
        bool mirrored = false; ///< up after several negative answers in a row, down after one positive
        bool fast_to_reversal = false; ///< one answer is enough until the first reversal
    };
    struct step {
        bool up;
        bool turned;      ///< true at a reversal
        std::size_t size; ///< place of the step's size
    };

    explicit up_down_rule(options o) noexcept : o_(o) {}

    /// Takes an answer. Returns the step, if the answer completes one.
    std::optional<step> answer(bool positive) noexcept
    {
        const bool counts = positive != o_.mirrored;
        in_row_ = counts ? in_row_ + 1 : 0;
        if (counts && in_row_ < (o_.fast_to_reversal && reversals_ == 0 ? 1 : o_.in_row))
            return {};
        in_row_ = 0;
        const bool turned = up_ && *up_ == positive;
        up_ = !positive;
        reversals_ += turned ? 1 : 0;
        return step{!positive, turned, std::min(reversals_ / 2, o_.sizes - 1)};
    }

    std::size_t reversals() const noexcept { return reversals_; }

private:
    options o_;
    unsigned in_row_ = 0;
    std::optional<bool> up_ = {}; ///< direction of the last step
    std::size_t reversals_ = 0;
};

} // namespace tactor::study
