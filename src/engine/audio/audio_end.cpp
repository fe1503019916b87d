// SPDX-License-Identifier: MIT
// End of the stream, with an amplifier behind it.
#include "engine/audio/audio_loop.hpp"

namespace tactor::engine {

void audio_loop::request_stop() noexcept
{
    if (!stop_requested_)
        stop_requested_ns_ = now_ns_;
    stop_requested_ = true;
}

void audio_loop::finish_when_silent() noexcept
{
    if (!scores_.empty())
        return;
    if (stop_frame_ == 0)
        stop_frame_ = played_ + setup_.period_frames; // also waits for the delay of the DAC itself
    if (played_ >= stop_frame_)
        finish(stop_why_, 0, true);
}

// Ends the stream. A DAC that stops while the amplifier is on pops, so the line goes off first, if possible.
// `runs`: the stream is in order, so zeros are written meanwhile.
void audio_loop::finish(reason_kind why, int code, bool runs) noexcept
{
    if (phase_ == phase::over)
        return;
    if (phase_ == phase::closing) {
        end_runs_ = false;
        return;
    }
    scores_.interrupt(why, code, played_, false);
    mixer_.cut(); // strokes that could not fade yet are reported, and silent
    end_why_ = why;
    end_code_ = code;
    end_runs_ = runs;
    closing_ns_ = now_ns_;
    phase_ = phase::closing;
    // Pairs with amplifier_driver::switch_on().
    link_.amplifier.ending.store(true, std::memory_order_seq_cst);
    if (link_.amplifier.off.load(std::memory_order_seq_cst))
        end();
}

void audio_loop::close_step(io_kind ready, std::int64_t now) noexcept
{
    if (link_.amplifier.off.load(std::memory_order_seq_cst) ||
        link_.amplifier.stuck.load(std::memory_order_seq_cst) || now - closing_ns_ >= options_.off_ns)
        return end();
    if (!end_runs_)
        return;
    if (ready == io_kind::ok || (ready == io_kind::again && idle_steps_ > 2))
        write_periods(now);
    else if (ready != io_kind::again)
        end_runs_ = false;
}

void audio_loop::end() noexcept
{
    sink_.drop();
    publish_clock({});
    phase_ = phase::over;
    // Replaces any other reason, because a person must act on this one.
    if (!link_.amplifier.off.load(std::memory_order_seq_cst)) {
        link_.amplifier.stuck.store(true, std::memory_order_seq_cst);
        end_why_ = reason_kind::left_on;
    }
    link_.reports.push({.what = report::kind::stream_over, .why = end_why_, .code = end_code_});
}

void audio_loop::obey_amplifier() noexcept
{
    if (phase_ != phase::running && phase_ != phase::suspended)
        return;
    const std::uint32_t mutes = link_.amplifier.mutes.load(std::memory_order_acquire);
    if (mutes != mutes_)
        scores_.mute();
    mutes_ = mutes;
    if (link_.amplifier.failed.load(std::memory_order_acquire) && stop_why_ == reason_kind::none) {
        request_stop();
        stop_why_ = reason_kind::amplifier;
        scores_.stop(state_kind::interrupted, reason_kind::amplifier);
    }
}

} // namespace tactor::engine
