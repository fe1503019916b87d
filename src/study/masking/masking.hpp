// SPDX-License-Identifier: MIT
/// \file
/// Masking noise that fades in and out on a separate device. `noise` makes the samples. `masking_stream`
/// writes the samples to the device; it has no thread and no clock. `masker` plays the stream in a thread
/// during a calibration or an experiment.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <poll.h>

#include <tactor/sink.hpp>

#include "rt/event_fd.hpp"
#include "rt/thread.hpp"
#include "study/random/random.hpp"

namespace tactor::study {

enum class noise_color {
    white, ///< the same power in every Hz
    pink,  ///< the same power in every octave
};
constexpr std::string_view to_string(noise_color c) noexcept
{
    return c == noise_color::white ? "white" : "pink";
}

/// Returns the greatest level of a noise, dBFS. White noise is uniformly distributed and never clips at this
/// level. Peaks of pink noise are more than 15 dB above the level once in several minutes; such peaks are
/// clipped at full scale.
constexpr double max_noise_dbfs(noise_color c) noexcept
{
    return c == noise_color::white ? -5.0 : -15.0;
}

/// Noise of one colour. Levels are root mean squares, in dB relative to a full-scale square wave.
class noise {
public:
    noise(noise_color c, double level_dbfs, std::string_view seed);

    /// Returns the next sample, -1 to 1. Does not block or allocate.
    double next() noexcept;

private:
    double filter_to_pink(double white) noexcept;

    noise_color color_;
    double gain_;
    random_numbers r_;
    std::array<double, 6> poles_{};
    double late_ = 0.0;
};

struct masking_options {
    noise_color color = noise_color::white;
    double level_dbfs = -30.0; ///< root mean square, dB relative to a full-scale square wave
    double fade_s = 0.05;      ///< duration of each fade, a raised cosine
    std::string seed = {};
    double patience_s = 5.0; ///< time beyond the fade after which masker::wait_for() gives up
};

/// State of the noise at the DAC.
enum class masking_state { silent, fading, full };

/// A stream of noise. All channels have the same samples. Only the constructor allocates, locks or throws.
class masking_stream {
public:
    masking_stream(sink& s, const masking_options& o);

    /// Prepares the sink, fills its buffer with silence and starts the sink.
    io_kind begin() noexcept;
    /// Fills the free space of the sink's buffer. After an xrun, counts a break and restarts the stream from
    /// silence. Returns `ok`, or the reason why the stream ended. `ready`: result of sink::ready(). `on`:
    /// true if the noise must fade in or play.
    io_kind step(io_kind ready, bool on) noexcept;

    masking_state state() noexcept;
    /// Returns how often an xrun has interrupted the stream.
    unsigned breaks() const noexcept { return breaks_; }
    const stream_setup& setup() const noexcept { return sink_.setup(); }

private:
    io_kind fill(std::size_t frames, bool on) noexcept;
    void make_block(std::size_t frames, bool on) noexcept;
    double next_gain(bool on) noexcept;
    io_kind recover_from_xrun(io_kind why) noexcept;

    sink& sink_;
    noise noise_;
    std::size_t frame_bytes_;
    std::uint32_t fade_frames_;
    std::vector<double> samples_;
    std::vector<std::byte> block_;
    std::size_t pending_ = 0; ///< frames of block_ that the sink has not taken yet
    std::size_t pending_from_ = 0;
    std::uint32_t faded_ = 0; ///< progress of the fade, from 0 (silent) to fade_frames_ (full)
    std::uint64_t made_ = 0;  ///< number of frames made since begin()
    std::optional<std::uint64_t> full_from_ = {};
    std::optional<std::uint64_t> silent_from_ = 0;
    unsigned breaks_ = 0;
    unsigned breaks_in_row_ = 0; ///< breaks without a played frame between them
};

/// A thread that plays noise between fade_in() and fade_out(), and silence at other times. For one caller at
/// a time.
class masker {
public:
    /// Starts the stream. Peaks above full scale are clipped: see max_noise_dbfs(). \throws error
    /// (runtime) if the stream does not start; std::system_error if the system has no thread or descriptor
    /// left.
    masker(std::unique_ptr<sink> s, const masking_options& o);
    /// Stops the sound without a fade. Call fade_out() and wait_for(masking_state::silent) first.
    ~masker();
    masker(const masker&) = delete;
    masker& operator=(const masker&) = delete;

    void fade_in() noexcept { request_noise(true); }
    void fade_out() noexcept { request_noise(false); }
    /// Function that waits until a descriptor is readable or a time has passed. The function returns false to
    /// give up.
    using waiter = std::function<bool(int descriptor, int timeout_ms)>;
    /// Blocks until the noise at the DAC has this state. Returns false if the device has failed, if the state
    /// does not come within the duration of the fade plus masking_options::patience_s, or if `wait` gives up.
    bool wait_for(masking_state s, const waiter& wait = poll_descriptor);

    /// Returns how often an xrun has interrupted the stream. If this number grows during a stimulus, the
    /// noise did not cover the whole stimulus.
    unsigned breaks() const noexcept { return breaks_; }
    /// Returns the reason why the stream ended; `ok` while the stream runs.
    io_kind end_reason() const noexcept { return ended_; }
    const stream_setup& setup() const noexcept { return stream_.setup(); }

private:
    static bool poll_descriptor(int descriptor, int timeout_ms);
    void request_noise(bool on) noexcept;
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
