// SPDX-License-Identifier: MIT
/// \file
/// Masking noise on a separate device, faded in and out: its samples, its stream, which has no thread and no
/// clock, and a thread that plays the stream through a calibration or an experiment.
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

/// Returns the greatest level that does not clip, dBFS. White noise is uniform. Pink noise has peaks: those
/// 15 dB above this level, once in minutes, are clipped at full scale.
constexpr double greatest_noise_dbfs(noise_color c) noexcept
{
    return c == noise_color::white ? -5.0 : -15.0;
}

/// Noise of one colour. Levels are roots of the mean square, in dB below that of a full-scale square.
class noise {
public:
    noise(noise_color c, double level_dbfs, std::string_view seed);

    /// Returns the next sample, -1 to 1. Does not block or allocate.
    double next() noexcept;

private:
    double shaped(double white) noexcept;

    noise_color color_;
    double gain_;
    random_numbers r_;
    std::array<double, 6> poles_{};
    double late_ = 0.0;
};

struct masking_options {
    noise_color color = noise_color::white;
    double level_dbfs = -30.0; ///< root of the mean square, dB below that of a full-scale square
    double fade_s = 0.05;      ///< raised cosine, in and out
    std::string seed = {};
    double patience_s = 5.0; ///< masker: time beyond the fade after which it gives up
};

/// Sound at the DAC.
enum class masking_state { silent, fading, full };

/// A stream of noise, the same on each channel. Only the constructor allocates, locks or throws.
class masking_stream {
public:
    masking_stream(sink& s, const masking_options& o);

    /// Prepares the sink, fills its buffer and starts it.
    io_kind begin() noexcept;
    /// Fills the free space. `ready` is the sink's reading of its descriptors. Counts an xrun and begins the
    /// stream again, from silence. Returns `ok`, or the reason for its end.
    io_kind step(io_kind ready, bool on) noexcept;

    masking_state state() noexcept;
    /// Number of times that the stream stood still.
    unsigned breaks() const noexcept { return breaks_; }
    const stream_setup& setup() const noexcept { return sink_.setup(); }

private:
    io_kind fill(std::size_t frames, bool on) noexcept;
    void make_block(std::size_t frames, bool on) noexcept;
    double next_gain(bool on) noexcept;
    io_kind again_after(io_kind why) noexcept;

    sink& sink_;
    noise noise_;
    std::size_t frame_bytes_;
    std::uint32_t fade_frames_;
    std::vector<double> samples_;
    std::vector<std::byte> block_;
    std::size_t pending_ = 0; ///< frames of block_ that the sink has not taken yet
    std::size_t pending_from_ = 0;
    std::uint32_t faded_ = 0; ///< 0: silent, fade_frames_: full
    std::uint64_t made_ = 0;  ///< frames of this epoch
    std::optional<std::uint64_t> full_from_ = {};
    std::optional<std::uint64_t> silent_from_ = 0;
    unsigned breaks_ = 0;
    unsigned breaks_in_row_ = 0; ///< without a frame played between
};

/// Plays silence, and noise between fade_in() and fade_out(). One caller at a time.
class masker {
public:
    /// Starts the stream. Peaks above full scale are clipped: see greatest_noise_dbfs(). \throws error
    /// (runtime) when the stream does not start; std::system_error if the system has no thread or descriptor
    /// left.
    masker(std::unique_ptr<sink> s, const masking_options& o);
    /// Cuts the sound: call fade_out() and wait_for(masking_state::silent) first.
    ~masker();
    masker(const masker&) = delete;
    masker& operator=(const masker&) = delete;

    void fade_in() noexcept { want(true); }
    void fade_out() noexcept { want(false); }
    /// Waits for a descriptor to be readable, or a time; returns false to give up.
    using waiter = std::function<bool(int descriptor, int timeout_ms)>;
    /// Blocks until that state is at the DAC. Returns false if the device has failed, if the state comes
    /// later than the fade and masking_options::patience_s allow, or if the waiter gave up.
    bool wait_for(masking_state s, const waiter& wait = poll_descriptor);

    /// Number of times that the stream stood still. If it grew during a stimulus, the noise did not cover
    /// that stimulus.
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
