// SPDX-License-Identifier: MIT
// Start, breaks, recovery and end of the stream.
#include <cerrno>

#include "engine/audio/audio_loop.hpp"
#include "rt/clock.hpp"

namespace tactor::engine {
namespace {

// Limit, because snd_pcm_resume() may return "not yet" for ever; a device needs a few seconds at most.
constexpr std::int64_t longest_resume = 10 * rt::ns_per_s;

reason_kind to_reason(io_kind s) noexcept
{
    switch (s) {
    case io_kind::xrun:
        return reason_kind::xrun;
    case io_kind::suspended:
        return reason_kind::suspended;
    case io_kind::lost:
        return reason_kind::lost;
    default:
        return reason_kind::failed;
    }
}

} // namespace

io_result audio_loop::start(std::int64_t now) noexcept
{
    now_ns_ = now;
    const io_result r = begin_epoch();
    if (r.status == io_kind::ok) {
        run_from(now);
        publish();
    }
    return r;
}

void audio_loop::run_from(std::int64_t now) noexcept
{
    phase_ = phase::running;
    moved(now);
    fresh_ = true;
}

io_result audio_loop::begin_epoch() noexcept
{
    mixer_.reset();
    pending_ = 0;
    played_ = 0;
    // A device that still sleeps fails here in each period. That is not a start.
    if (const io_kind s = sink_.prepare(); s != io_kind::ok)
        return {s, 0, 0};
    clock_.begin_epoch(offset_);
    publish_clock(clock_.line());
    std::size_t filled = 0;
    while (filled < setup_.buffer_frames && pending_ == 0) {
        mix_period();
        const io_result r = write_pending();
        if (r.status != io_kind::ok && r.status != io_kind::again)
            return r;
        filled += r.frames;
    }
    if (filled == 0)
        return {io_kind::failed, 0, -EIO};
    epoch_ns_ = now_ns_;
    return {sink_.start(), filled, 0};
}

void audio_loop::broken(io_kind s, int code, std::int64_t now) noexcept
{
    if (phase_ == phase::closing) {
        end_runs_ = end_runs_ && (s == io_kind::ok || s == io_kind::again);
        return; // nothing sounds any more; the loop only waits for the amplifier
    }
    switch (s) {
    case io_kind::ok:
    case io_kind::again:
        return;
    case io_kind::xrun:
        link_.count.count_xrun(sink_.xrun_ns());
        // The DAC stopped because it had played everything.
        silence_all(reason_kind::xrun, code, mixer_.position() - pending_);
        return too_often(now) ? finish(reason_kind::lost, -EPIPE) : restart(now);
    case io_kind::suspended:
        return fall_asleep(code, now);
    case io_kind::lost:
    case io_kind::failed:
        return finish(to_reason(s), code);
    }
}

// Ends the strokes that had begun, because nothing resumes in mid-burst. Returns the others to be handed over
// again.
void audio_loop::silence_all(reason_kind why, int code, std::uint64_t played) noexcept
{
    note_starts(played);
    scores_.interrupt(why, code, played, !stop_requested_);
    offset_ += mixer_.position();
    publish_clock({});
    mixer_.reset();
    pending_ = 0;
    played_ = 0;
}

void audio_loop::fall_asleep(int code, std::int64_t now) noexcept
{
    link_.count.suspends.fetch_add(1, std::memory_order_release);
    silence_all(reason_kind::suspended, code, played_);
    phase_ = phase::suspended;
    suspended_ns_ = now;
}

void audio_loop::try_resume(std::int64_t now) noexcept
{
    if (stop_requested_)
        return finish(stop_why_, 0);
    scores_.handle_live_requests(); // this runs in the mix, and there is no mix now
    if (sink_.resume() == io_kind::again && now - suspended_ns_ < longest_resume)
        return;
    // Begins a new epoch, resumed or not: the buffer holds frames of strokes that were interrupted.
    restart(now);
}

void audio_loop::restart(std::int64_t now) noexcept
{
    if (stop_requested_)
        return finish(stop_why_, 0);
    io_result r = begin_epoch();
    while (r.status == io_kind::xrun) {
        silence_all(reason_kind::xrun, r.code, 0);
        if (too_often(now))
            return finish(reason_kind::lost, -EPIPE);
        r = begin_epoch();
    }
    if (r.status == io_kind::ok)
        run_from(now);
    else if (r.status == io_kind::suspended)
        fall_asleep(r.code, now); // not awake yet: try again in the next period
    else
        finish(to_reason(r.status), r.code);
}

bool audio_loop::too_often(std::int64_t now) noexcept
{
    std::int64_t& oldest = recoveries_[recovered_ % recoveries_.size()];
    if (recovered_ >= recoveries_.size() && now - oldest < rt::ns_per_s)
        return true;
    oldest = now;
    ++recovered_;
    return false;
}

} // namespace tactor::engine
