// SPDX-License-Identifier: MIT
#include "study/experiment/run_queue.hpp"

namespace tactor::study {

run_queue::run_queue(std::size_t trials)
{
    for (std::size_t i = 0; i < trials; ++i)
        all_.push_back({static_cast<unsigned>(i + 1), 1});
}

void run_queue::take(bool is_void)
{
    const pending_trial t = all_.at(at_++);
    last_counts_ = !is_void;
    if (is_void)
        all_.push_back({t.trial, t.attempt + 1});
}

bool run_queue::take_back()
{
    if (!last_counts_)
        return false;
    const pending_trial t = all_.at(at_ - 1);
    last_counts_ = false;
    all_.push_back({t.trial, t.attempt + 1});
    return true;
}

} // namespace tactor::study
