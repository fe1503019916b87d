// SPDX-License-Identifier: MIT
/// \file
/// Sinks, to which the audio thread writes frames: a PCM, a test device, or a class of your own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <poll.h>

#include <tactor/api.hpp>
#include <tactor/choices.hpp>

namespace tactor {
inline namespace v0 {

/// Map from the channels of a stream to the channels of the device.
struct stream_wiring {
    /// For each channel of the stream: the device channels that it reaches, ascending. The channels of a
    /// second device count from 1024. A channel of the stream that reaches no device channel is lost. Empty:
    /// each channel reaches the device channel with the same number.
    std::vector<std::vector<unsigned>> outputs = {};
    /// Factors on the samples, in the order of `outputs`; a factor below 0 reverses the polarity. An output
    /// with a gain below 0.001 (-60 dB) counts as not reached. Empty: all factors are 1.
    std::vector<std::vector<double>> gains = {};
    /// Plugin on the route whose level is not known, such as "type softvol". Empty: none.
    std::string level_by = {};
    /// Plugin on the route that may move channels, such as "type pulse", so that `outputs` is not known.
    /// Empty: `outputs` is known.
    std::string hidden_by = {};
    /// Largest factor on the samples of any channel after one of the tables on the route, 1 or more. If it is
    /// above 1, ALSA may clip samples at that table, whatever the `gains` of the whole route are.
    double most_gain = 1.0;
};

/// Negotiated stream. While the sink lives, only has_clock may change.
struct stream_setup {
    std::string name;        ///< as the user named it
    std::string device = {}; ///< name under which drive times are kept; empty: drive times are not kept
    unsigned channels = 0;
    unsigned device_channels =
        0;             ///< channels of the PCM; those beyond `channels` are silent; 0: equal to `channels`
    unsigned rate = 0; ///< Hz
    format_kind format = format_kind::s32;
    unsigned period_frames = 0;
    unsigned buffer_frames = 0;
    bool batch = false;        ///< the position moves by whole periods
    bool planar = false;       ///< the device takes a block for each channel; write() still takes frames
    bool has_clock = true;     ///< false for null and file devices, which the sink paces; known after start()
    stream_wiring wiring = {}; ///< map from this stream to the device

    /// Returns the number of bytes of one frame.
    [[nodiscard]] std::size_t frame_bytes() const noexcept { return channels * sample_bytes(format); }
};

/// Outcome of a call on a sink. A plain value, because the audio thread does not throw.
enum class io_kind {
    ok,
    again,     ///< no space now
    xrun,      ///< the device ran dry; the stream has stopped
    suspended, ///< the system sleeps or slept
    lost,      ///< unplugged, or its position stands still
    failed,    ///< any other failure; final
};
TACTOR_KIND(io_kind);

/// Result of a call on a sink.
struct io_result {
    io_kind status = io_kind::ok;
    std::size_t frames = 0; ///< frames taken
    int code = 0;           ///< negative errno of the device if status is not ok
};

/// Position of the stream at one instant.
struct stream_position {
    std::uint64_t written = 0; ///< frames written in this epoch, the prefill included
    std::uint64_t played = 0;  ///< of these, frames that have reached the DAC
    std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC of the reading
    bool valid = false;        ///< if it is false for player_options::stall_s, the device counts as lost
};

/// A stream of interleaved frames. Order of calls: prepare(), write() silence (prefill), start(); then wait
/// on the descriptors and write(). Only the audio thread calls the `noexcept` members: they must not block,
/// lock, allocate or log.
class TACTOR_API sink {
public:
    sink() = default;
    sink(const sink&) = delete;
    sink& operator=(const sink&) = delete;
    virtual ~sink();

    /// Returns the negotiated stream. Rate, channels and period are above 0, and the buffer has one period or
    /// more.
    [[nodiscard]] virtual const stream_setup& setup() const noexcept = 0;

    /// Makes the stream ready to be filled, at first and after each xrun. Begins a new epoch.
    [[nodiscard]] virtual io_kind prepare() noexcept = 0;
    /// Starts the DAC explicitly, after the prefill.
    [[nodiscard]] virtual io_kind start() noexcept = 0;
    /// Tries to return from `suspended`. Returns `again` while the device is not ready.
    [[nodiscard]] virtual io_kind resume() noexcept = 0;
    /// Returns the time in ns for which the stream stood still in the xrun that was just reported, or 0 if
    /// this time is not known. Called before prepare().
    [[nodiscard]] virtual std::int64_t xrun_ns() noexcept;

    /// Returns an upper bound of the number of descriptors.
    [[nodiscard]] virtual std::size_t max_descriptors() const noexcept = 0;
    /// Fills `fds` with the descriptors to poll and returns their number.
    [[nodiscard]] virtual std::size_t descriptors(std::span<pollfd> fds) noexcept = 0;
    /// Interprets the polled descriptors: `ok` if there is space to write, `again` if not, or an error.
    [[nodiscard]] virtual io_kind ready(std::span<pollfd> fds) noexcept = 0;

    /// Returns the number of frames that can be written now.
    [[nodiscard]] virtual io_result available() noexcept = 0;
    /// Writes whole interleaved frames. May take fewer frames than offered, even none.
    [[nodiscard]] virtual io_result write(std::span<const std::byte> frames) noexcept = 0;
    [[nodiscard]] virtual stream_position position() noexcept = 0;
    /// Stops at once and discards the queued frames.
    virtual void drop() noexcept = 0;
};

/// A sink for a target without a clock: a socket, a pipe, a simulation. CLOCK_MONOTONIC sets the pace: frames
/// leave the sink at the sample rate. If the writer is late, the sink's time waits for the writer, so there
/// are no xruns. Derive from this class and implement take().
class TACTOR_API paced_sink : public sink {
public:
    /// Uses name, device, channels (1 to 1024), rate (8000 to 768000 Hz) and format of `s`. period_frames (50
    /// us at least) and buffer_frames (two periods at least) may be 0, which means 96 frames and three
    /// periods.
    /// \throws error: bad_input for numbers out of range, runtime if no timer is available.
    explicit paced_sink(stream_setup s);
    ~paced_sink() override;

    [[nodiscard]] const stream_setup& setup() const noexcept final;
    [[nodiscard]] io_kind prepare() noexcept final;
    [[nodiscard]] io_kind start() noexcept final;
    [[nodiscard]] io_kind resume() noexcept final;
    [[nodiscard]] std::size_t max_descriptors() const noexcept final;
    [[nodiscard]] std::size_t descriptors(std::span<pollfd> fds) noexcept final;
    [[nodiscard]] io_kind ready(std::span<pollfd> fds) noexcept final;
    [[nodiscard]] io_result available() noexcept final;
    [[nodiscard]] io_result write(std::span<const std::byte> frames) noexcept final;
    [[nodiscard]] stream_position position() noexcept final;
    void drop() noexcept final;

protected:
    /// Takes the next interleaved frames of the stream: at most one period, and at most buffer_frames before
    /// their time. `first` is the number of the first of these frames, counted from the start of the epoch.
    /// The audio thread calls this: it must not block, lock, allocate or log. Returns `ok`, or `lost` or
    /// `failed`, which end the stream.
    [[nodiscard]] virtual io_kind take(std::uint64_t first, std::span<const std::byte> frames) noexcept = 0;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace v0
} // namespace tactor
