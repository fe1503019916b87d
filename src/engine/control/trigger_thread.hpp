// SPDX-License-Identifier: MIT
/// \file
/// The thread that sends sync pulses.
#pragma once

#include <atomic>
#include <cstdint>

#include "engine/control/pulse_board.hpp"
#include "engine/control/pulses.hpp"
#include "engine/link.hpp"
#include "rt/event_fd.hpp"
#include "rt/thread.hpp"
#include "rt/triple_buffer.hpp"

namespace tactor::engine {

/// Pulses are not sent by the audio thread, because its periods would be their jitter. This thread stands
/// above it, so it may not wait for any other: it has neither mutex nor heap in common with another thread.
/// The members are for the control side, one caller at a time.
class trigger_thread {
public:
    /// Reads link::sync_clock for the due times. \throws std::system_error when no thread can be started.
    trigger_thread(link& l, enable_line& line, std::int64_t pulse_ns, const rt::thread_options& t);
    /// The line is off after it.
    ~trigger_thread();
    trigger_thread(const trigger_thread&) = delete;
    trigger_thread& operator=(const trigger_thread&) = delete;

    /// Plans a pulse for when this frame of the stream is at the DAC, in the running epoch of `clock`.
    void add(stroke_id id, std::uint64_t frame, const clock_line& clock);
    void forget(stroke_id id, bool was_played) { plan_.forget(id, was_played); }
    /// Called when link::to_control was signalled: there may be places now for pulses that had none.
    void hand_over();
    pulse_stats stats() noexcept;

private:
    void run() noexcept;
    std::int64_t step() noexcept;
    void wait(std::int64_t ns) noexcept;

    link& link_;
    enable_line& line_;
    pulse_board board_;
    pulse_plan plan_{board_}; ///< the control side's
    rt::triple_buffer<pulse_stats> stats_;
    pulse_emitter emitter_;
    rt::event_fd wake_;
    std::atomic<bool> over_{false};
    rt::thread thread_;
};

} // namespace tactor::engine
