// SPDX-License-Identifier: MIT
/// \file
/// The transformed up-down rule of adaptive procedures (Levitt 1971), for levels or for positions in a list.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

namespace tactor::study {

/// The transformed up-down rule. Several positive answers in a row cause a step down; one negative answer
/// causes a step up. After every second reversal, the next step size applies. The caller changes the level.
class up_down_rule {
public:
    struct options {
        unsigned in_row = 1;   ///< number of answers in a row that cause a step, above 0
        std::size_t sizes = 1; ///< number of step sizes, above 0
        bool mirrored = false; ///< true for up after several negative answers, down after one positive
        bool fast_to_reversal = false; ///< true if one answer causes a step until the first reversal
    };
    struct step {
        bool up;
        bool turned;      ///< true at a reversal
        std::size_t size; ///< index of the step's size
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
