// SPDX-License-Identifier: MIT
#include "session/stream_policy.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace tactor::session {
namespace {

constexpr double longest_pause_s = 5.0;
constexpr double renewed_s = 0.5; // interval of keeping drive time while strokes go on

stream_policy::time later(stream_policy::time t, double s)
{
    constexpr double for_ever = 1e9;
    return s >= for_ever
               ? stream_policy::time::max()
               : t + std::chrono::ceil<stream_policy::time::duration>(std::chrono::duration<double>(s));
}

} // namespace

std::string_view to_string(stream_state s) noexcept
{
    constexpr std::array<std::string_view, 5> names{"running", "idle", "lost", "muted", "closing"};
    return names[static_cast<std::size_t>(s)];
}

stream_policy::act stream_policy::step(time now)
{
    again_.reset();
    return phase_ == phase::open ? step_open(now) : phase_ == phase::shut ? step_shut(now) : act::nothing;
}

// Time begins with the first call.
bool stream_policy::is_due(time now, double after_s)
{
    again_ = due_ = due_.value_or(later(now, after_s));
    return now >= *due_;
}

stream_policy::act stream_policy::step_shut(time now)
{
    if (is_over() || wanted_ || state_ == stream_state::idle)
        return wanted_ && !is_over() ? act::open : act::nothing;
    if (!give_up_at_)
        give_up_at_ = later(now, times_.wait_s);
    if (!due_) {
        given_up_ = now >= *give_up_at_;
        if (given_up_)
            return act::nothing;
        due_ = std::min(later(now, pause_s_), *give_up_at_);
        pause_s_ = std::min(2.0 * pause_s_, longest_pause_s);
    }
    return is_due(now, 0.0) ? act::open : act::nothing;
}

stream_policy::act stream_policy::step_open(time now)
{
    if (broken_ || closing_)
        return act::close;
    // An opening proves little: a full disk or a loose cable shows with the first periods.
    if (proves_ && is_due(now, times_.proof_s))
        run();
    if (!proves_ && !busy_ && times_.idle_stop_s > 0.0 && is_due(now, times_.idle_stop_s)) {
        set(stream_state::idle, "nothing was drawn for a while; the next stroke starts it");
        return act::close;
    }
    if (busy_)
        again_ = std::min(again_.value_or(time::max()), later(now, renewed_s));
    return act::nothing;
}

void stream_policy::opened()
{
    phase_ = phase::open;
    wanted_ = broken_ = false;
    if (!proves_)
        run();
}

void stream_policy::run()
{
    proves_ = false;
    pause_s_ = times_.retry_s;
    again_.reset();
    due_.reset();
    give_up_at_.reset();
    set(stream_state::running, "");
}

void stream_policy::failed(std::string why)
{
    phase_ = phase::shut;
    wanted_ = false;
    proves_ = true;
    set(stream_state::lost, std::move(why));
}

void stream_policy::ended(std::string why)
{
    if (phase_ != phase::open || std::exchange(broken_, true))
        return;
    proves_ = true;
    set(stream_state::lost, std::move(why));
}

void stream_policy::stopped()
{
    if (phase_ == phase::open && !std::exchange(broken_, true))
        set(stream_state::idle, "everything was stopped; the next stroke starts it");
}

void stream_policy::closed(bool left_on)
{
    phase_ = phase::shut;
    if (!left_on)
        return;
    given_up_ = true;
    set(stream_state::lost, "the amplifier may be on: its line cannot be switched off (cut the amplifier's "
                            "supply, then start the service again)");
}

void stream_policy::mute(bool is)
{
    if (state_ == stream_state::running || state_ == stream_state::muted)
        set(is ? stream_state::muted : stream_state::running,
            is ? "the amplifier is off until the stream is sound" : "");
}

void stream_policy::set_busy(bool is)
{
    if (std::exchange(busy_, is) != is && !proves_ && phase_ == phase::open)
        due_.reset(); // of the idle stop
}

void stream_policy::end()
{
    closing_ = true;
    set(stream_state::closing, "the server ends");
}

void stream_policy::set(stream_state s, std::string reason)
{
    if (state_ == stream_state::closing) // the last state
        return;
    state_ = s;
    reason_ = std::move(reason);
}

} // namespace tactor::session
