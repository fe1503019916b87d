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

/// What is left of a run: its trials in order, and behind them those that were void.
class run_queue {
public:
    explicit run_queue(std::size_t trials);

    bool done() const noexcept { return at_ >= all_.size(); }
    /// The next trial; there must be one.
    pending_trial next() const { return all_.at(at_); }
    /// It was played; where it was void it comes again.
    void take(bool is_void);
    /// The last that was taken counted, and does not any more: it comes again. False where there is none.
    bool take_back();

private:
    std::vector<pending_trial> all_ = {};
    std::size_t at_ = 0;
    bool last_counts_ = false;
};

} // namespace tactor::study
