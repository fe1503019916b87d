// SPDX-License-Identifier: MIT
#include "study/experiment/trial_order.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace tactor::study {
namespace {

/// State of an order while it is built: the trials that it lacks, and the row at its end. A row consists of
/// consecutive trials with the same motion.
struct rest_of_order {
    std::vector<std::size_t> left = {}; ///< number of missing trials by motion
    std::size_t all = 0;                ///< sum of `left`
    std::size_t last = 0;               ///< motion of the row
    std::size_t row = 0;                ///< length of the row

    explicit rest_of_order(std::span<const planned_trial> trials) : all(trials.size())
    {
        for (const planned_trial& t : trials) {
            left.resize(std::max(left.size(), t.motion + 1));
            ++left[t.motion];
        }
    }

    void remove_trial(std::size_t motion)
    {
        row = motion == last ? row + 1 : 1;
        last = motion;
        --left[motion];
        --all;
    }

    // Returns true if the remaining trials can be ordered: n trials of other motions leave room for n + 1
    // rows of a motion, each with at most `most` trials.
    bool has_order(std::size_t most) const
    {
        bool has = row <= most;
        for (std::size_t m = 0; m < left.size(); ++m)
            has = has && left[m] + (m == last ? row : 0) <= most * (all - left[m] + 1);
        return has;
    }
};

bool has_longer_row(std::span<const planned_trial> trials, std::size_t most)
{
    std::size_t row = 0;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        row = i > 0 && trials[i].motion == trials[i - 1].motion ? row + 1 : 1;
        if (row > most)
            return true;
    }
    return false;
}

// Returns the share of random orders in which no row is longer than `most`, if all motions are equally likely
// at each place.
double valid_order_share(std::size_t trials, std::size_t motions, std::size_t most)
{
    const double again = 1.0 / static_cast<double>(motions);
    std::vector<double> ends(most, 0.0); // shares of the orders that end with a row of 1, 2, ...
    ends.front() = 1.0;
    const auto sum = [&ends] { return std::accumulate(ends.begin(), ends.end(), 0.0); };
    for (std::size_t i = 1; i < trials; ++i) {
        const double other = sum() * (1.0 - again);
        std::shift_right(ends.begin(), ends.end(), 1);
        for (double& share : ends)
            share *= again;
        ends.front() = other;
    }
    return sum();
}

// Builds an order from the front. For each place, takes the first of the shuffled trials that leaves an
// allowed order for the remaining trials.
void build_order(std::span<planned_trial> trials, std::size_t most)
{
    rest_of_order rest(trials);
    for (; !trials.empty(); trials = trials.subspan(1)) {
        const auto next = std::ranges::find_if(trials, [&](const planned_trial& t) {
            rest_of_order then = rest;
            then.remove_trial(t.motion);
            return then.has_order(most);
        });
        rest.remove_trial(next->motion);
        std::iter_swap(trials.begin(), next);
    }
}

} // namespace

bool has_order(std::span<const planned_trial> trials, std::size_t most)
{
    return rest_of_order(trials).has_order(most);
}

void order_trials(std::span<planned_trial> trials, std::size_t most, random_numbers& numbers)
{
    // If at least one of `draws` random orders is expected to be allowed, draws until one is allowed. All
    // allowed orders are then equally likely.
    const std::size_t draws =
        std::min(std::size_t{1000000}, std::size_t{200000000} / std::max(trials.size(), std::size_t{1}));
    const auto motions = static_cast<std::size_t>(
        std::ranges::count_if(rest_of_order(trials).left, [](std::size_t n) { return n > 0; }));
    const double share = valid_order_share(trials.size(), std::max(motions, std::size_t{1}), most);
    for (std::size_t i = 0; share * static_cast<double>(draws) >= 1.0 && i < draws; ++i) {
        shuffle(trials, numbers);
        if (!has_longer_row(trials, most))
            return;
    }
    shuffle(trials, numbers);
    build_order(trials, most);
}

} // namespace tactor::study
