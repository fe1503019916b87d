// SPDX-License-Identifier: MIT
/// \file
/// Masking noise in a separate thread, for a calibration or an experiment.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include <poll.h>

#include <tactor/sink.hpp>

#include "rt/event_fd.hpp"
#include "rt/thread.hpp"
#include "study/masking/masking_stream.hpp"

namespace tactor::study {

/// Plays silence, and noise between fade_in() and fade_out(). One caller at a time.
class masker {
public:
    /// Starts the stream. Peaks above full scale are clipped: see greatest_noise_dbfs(). \throws error
    /// (runtime) when the stream does not start; std::system_error if the system has no thread or descriptor
    /// left.
    masker(std::unique_ptr<sink> s, const masking_options& o);
    /// Cuts the sound: call fade_out() and wait_for(masking_state::silent) before.
    ~masker();
    masker(const masker&) = delete;
    masker& operator=(const masker&) = delete;

    void fade_in() noexcept { want(true); }
    void fade_out() noexcept { want(false); }
    /// Waits for a descriptor to be readable, or a time; returns false to give up.
    using waiter = std::function<bool(int descriptor, int timeout_ms)>;
    /// Blocks until that state is at the DAC. Returns false if the device has failed, takes
    /// masking_options::patience_s longer than the fade, or the waiter gave up.
    bool wait_for(masking_state s, const waiter& wait = poll_descriptor);

    /// Number of times that the stream stood still: noise did not cover a stimulus during which it changed.
    unsigned breaks() const noexcept { return breaks_; }
    /// Reason for the end of the stream; `ok` while it goes on.
    io_kind ended() const noexcept { return ended_; }
    const stream_setup& setup() const noexcept { return stream_.setup(); }

private:
    static bool poll_descriptor(int descriptor, int timeout_ms);
    void want(bool on) noexcept;
    void run() noexcept;
    io_kind wait() noexcept;

    std::unique_ptr<sink> sink_;
    std::chrono::duration<double> patience_;
    masking_stream stream_;
    std::vector<pollfd> fds_;
    rt::event_fd wake_;
    rt::event_fd changed_;
    std::atomic<bool> on_{false};
    std::atomic<bool> over_{false};
    std::atomic<masking_state> state_{masking_state::silent};
    std::atomic<unsigned> breaks_{0};
    std::atomic<io_kind> ended_{io_kind::ok};
    std::unique_ptr<rt::thread> thread_;
};

} // namespace tactor::study
