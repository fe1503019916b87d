// SPDX-License-Identifier: MIT
/// \file
/// The adaptive staircase of a tactor (Levitt 1971), as a pure machine: a level out, an answer in.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace tactor::study {

/// Lowest level: below it nothing is left of a sample of 24 bits.
inline constexpr double floor_dbfs = -144.0;
/// Reversals after which the threshold stands as it is.
inline constexpr std::size_t most_reversals = 24;

/// Check trials above the threshold, and as many below it; and right ones below it that show that it is too
/// high. Guesses reach that in 11 of 1024 series.
inline constexpr std::size_t check_count = 10;
inline constexpr std::size_t too_many_below = 9;

struct staircase_options {
    unsigned right_for_down = 3; ///< 3: 79.4 %, 2: 70.7 %
    double start_dbfs = -20.0;
    double ceiling_dbfs = 0.0;
    std::vector<double> steps_db = {4.0, 2.0, 1.0}; ///< the next from every second reversal on
    std::size_t reversals = 12;                     ///< at most most_reversals
    std::size_t discard = 4;                        ///< the first of them; two at least are left
};

enum class staircase_end {
    felt,
    not_felt,
    below_range, ///< right at floor_dbfs: by something else than what the skin feels
};

/// Mean and standard deviation (n - 1) of the reversals that count, an even number of the last ones.
struct reversal_mean {
    double mean_dbfs = 0.0;
    double sd_db = 0.0;
    double halves_db = 0.0; ///< how far the means of the halves are apart
};
/// Averages the last `counted` reversals.
reversal_mean average_reversals(std::span<const double> reversals_dbfs, std::size_t counted);

/// A tactor's measurement: a staircase, check trials above its threshold, check trials below it. Where the
/// trials below are right the staircase runs once more, from there.
class staircase {
public:
    explicit staircase(staircase_options o);

    /// Returns the level of the next trial; check trials included.
    double level_dbfs() const noexcept { return level_; }
    std::optional<staircase_end> end() const noexcept { return end_; }
    /// Takes the answer to the trial at level_dbfs(). Returns true if it turned the direction.
    bool answer(bool right);

    /// Trials of both staircases, and their check trials.
    std::size_t trials() const noexcept { return trials_; }
    /// Staircases begun: 1 or 2.
    std::size_t staircases() const noexcept { return staircases_; }
    /// Reversals of the last staircase. The functions below are about that one, too.
    const std::vector<double>& reversals_dbfs() const noexcept { return run_.reversals; }
    /// Right answers to the check trials above and below the threshold; nothing before there were any.
    std::optional<std::size_t> check_right() const noexcept { return run_.above.right_answers(); }
    std::optional<std::size_t> check_below_right() const noexcept { return run_.below.right_answers(); }
    /// Threshold by the reversals; also of a tactor that was not felt, if it came so far.
    std::optional<reversal_mean> threshold() const noexcept { return run_.threshold; }

private:
    struct check_trials {
        std::size_t given = 0;
        std::size_t right = 0;

        std::optional<std::size_t> right_answers() const noexcept
        {
            return given == 0 ? std::nullopt : std::optional(right);
        }
    };
    struct run {
        unsigned right_in_row = 0;
        std::optional<bool> up = {};
        std::vector<double> reversals = {};
        std::vector<bool> at_ceiling = {}; ///< right or not
        unsigned right_at_floor = 0;
        std::optional<reversal_mean> threshold = {};
        check_trials above = {};
        check_trials below = {};
    };

    bool step(bool right);
    bool turn(bool up);
    void note_at_ceiling(bool right);
    void note_at_floor(bool right);
    void settle();
    void check(bool right);
    void go_to(double level_dbfs);

    staircase_options o_;
    double level_;
    run run_ = {};
    std::size_t staircases_ = 1;
    std::size_t trials_ = 0;
    std::optional<staircase_end> end_ = {};
};

} // namespace tactor::study
