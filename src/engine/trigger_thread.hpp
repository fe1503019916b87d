// SPDX-License-Identifier: MIT
/// \file
/// The thread that sends sync pulses.
#pragma once

#include <atomic>
#include <mutex>

#include "engine/link.hpp"
#include "engine/pulses.hpp"
#include "rt/event_fd.hpp"
#include "rt/thread.hpp"

namespace tactor::engine {

/// Not the audio thread, whose periods would be the pulse's jitter. add() and forget() may be called from
/// any thread but that one.
class trigger_thread {
public:
    /// `clock` is read for the due times. \throws std::system_error when there is no thread to be had.
    trigger_thread(const rt::seqlock<clock_line>& clock, enable_line& line, std::int64_t pulse_ns,
                   const rt::thread_options& t);
    /// The line is off after it.
    ~trigger_thread();
    trigger_thread(const trigger_thread&) = delete;
    trigger_thread& operator=(const trigger_thread&) = delete;

    /// A pulse when this frame of the stream is at the DAC, in the epoch that runs now.
    void add(stroke_id id, std::uint64_t frame);
    void forget(stroke_id id);
    pulse_stats stats() const;

private:
    void run() noexcept;
    std::int64_t step() noexcept;
    void wait(std::int64_t ns) noexcept;

    const rt::seqlock<clock_line>& clock_;
    enable_line& line_;
    mutable std::mutex mutex_; ///< guards the plan and the copy of the numbers; held for moments only
    pulse_plan plan_;
    pulse_stats stats_;
    pulse_emitter emitter_;
    rt::event_fd wake_;
    std::atomic<bool> over_{false};
    rt::thread thread_;
};

} // namespace tactor::engine
