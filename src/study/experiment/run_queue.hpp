// SPDX-License-Identifier: MIT
/// \file
/// What is left of a run.
#pragma once

#include <cstddef>
#include <vector>

namespace tactor::study {

/// A trial of a run that is to come.
struct pending_trial {
    unsigned trial = 1;
    unsigned attempt = 1;

    friend bool operator==(const pending_trial&, const pending_trial&) = default;
};

/// The rest of a run: its trials in order, and behind them those that were void.
class run_queue {
public:
    explicit run_queue(std::size_t trials)
    {
        for (std::size_t i = 0; i < trials; ++i)
            all_.push_back({static_cast<unsigned>(i + 1), 1});
    }

    bool done() const noexcept { return at_ >= all_.size(); }
    /// The next trial; there must be one.
    pending_trial next() const { return all_.at(at_); }
    /// Takes the next trial, which was played; where it was void it comes again.
    void take(bool is_void)
    {
        const pending_trial t = all_.at(at_++);
        last_counts_ = !is_void;
        if (is_void)
            all_.push_back({t.trial, t.attempt + 1});
    }
    /// Takes back the last trial that was taken and counted: it comes again. False where there is none.
    bool take_back()
    {
        if (!last_counts_)
            return false;
        const pending_trial t = all_.at(at_ - 1);
        last_counts_ = false;
        all_.push_back({t.trial, t.attempt + 1});
        return true;
    }

private:
    std::vector<pending_trial> all_ = {};
    std::size_t at_ = 0;
    bool last_counts_ = false;
};

} // namespace tactor::study
