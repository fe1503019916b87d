// SPDX-License-Identifier: MIT
#include "study/experiment/session_flow.hpp"

#include <utility>

namespace tactor::study {

session_flow::session_flow(std::vector<flow_run> runs, bool consent, unsigned tactors)
    : runs_(std::move(runs)), ask_consent_(consent), tactors_(tactors)
{
    leave_done_run(false);
}

void session_flow::leave_done_run(bool rest)
{
    while (run_ < runs_.size() && runs_[run_].trials.done()) {
        if (rest && runs_[run_].rest && run_ + 1 < runs_.size()) {
            place_ = place::rest;
            return;
        }
        ++run_;
        place_ = place::introduce;
    }
}

session_step session_flow::next() const
{
    if (run_ == runs_.size())
        return {.what = step_kind::over};
    if (ask_consent_)
        return {.what = step_kind::consent};
    if (walked_ < tactors_)
        return {.what = step_kind::walk, .tactor = walked_};
    if (place_ == place::rest)
        return {.what = step_kind::rest, .run = run_};
    if (paused_)
        return {.what = step_kind::pause, .run = run_};
    if (place_ == place::introduce)
        return {.what = step_kind::introduce, .run = run_};
    const flow_run& r = runs_[run_];
    session_step s{.what = step_kind::trial, .run = run_};
    s.practice = r.practised < r.practice;
    s.which = s.practice ? pending_trial{r.practised + 1, 1} : r.trials.next();
    return s;
}

void session_flow::go_on()
{
    switch (next().what) {
    case step_kind::pause:
        paused_ = false;
        void_in_row_ = 0;
        break;
    case step_kind::rest:
        leave_done_run(false);
        break;
    case step_kind::introduce:
        place_ = place::trials;
        has_last_ = false;
        break;
    default:
        break;
    }
}

void session_flow::took(bool is_void)
{
    flow_run& r = runs_[run_];
    void_in_row_ = is_void ? void_in_row_ + 1 : 0;
    paused_ = paused_ || void_in_row_ == most_void_in_row;
    if (r.practised < r.practice) {
        ++r.practised;
        return;
    }
    r.trials.take(is_void);
    last_run_ = run_;
    has_last_ = true;
    leave_done_run(true);
}

bool session_flow::void_last()
{
    if (!has_last_ || !runs_[last_run_].trials.take_back())
        return false;
    has_last_ = false;
    if (run_ != last_run_ || place_ == place::rest) {
        run_ = last_run_;
        place_ = place::trials;
    }
    return true;
}

} // namespace tactor::study
