// SPDX-License-Identifier: MIT
/// \file
/// A configured PCM as a sink.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/sink.hpp>

#include "sink/alsa/handle.hpp"
#include "sink/pacer.hpp"

namespace tactor::pcm {

/// Frames go to snd_pcm_writei(). A device that turns out at start() to have no clock is paced by a timer.
///
/// A card plays its buffer round and round, and tells the kernel the place in it. If nobody asks for this
/// place during a whole round (interrupts were off, the processor or the machine stood still), the round is
/// missing from the position, and no xrun is reported. So a stream that moved, and was not looked at during a
/// whole round, counts as run dry here, whatever the kernel says.
class pcm_sink final : public sink {
public:
    /// `on_card`: the PCM plays on a card of the kernel's.
    pcm_sink(handle h, stream_setup s, bool on_card);

    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override;
    io_kind start() noexcept override;
    io_kind resume() noexcept override;
    std::int64_t xrun_ns() noexcept override;
    std::size_t max_descriptors() const noexcept override { return max_descriptors_; }
    std::size_t descriptors(std::span<pollfd> fds) noexcept override;
    io_kind ready(std::span<pollfd> fds) noexcept override;
    io_result available() noexcept override;
    io_result write(std::span<const std::byte> frames) noexcept override;
    stream_position position() noexcept override;
    void drop() noexcept override;

private:
    int state() noexcept { return static_cast<int>(snd_pcm_state(handle_.get())); }
    const std::byte* widen(std::span<const std::byte> frames) noexcept;
    long write_paced(const std::byte* data, std::size_t frames) noexcept;
    bool runs_without_clock() noexcept;
    std::int64_t ns_of(std::uint64_t frames) const noexcept;
    void look(std::int64_t now, snd_pcm_sframes_t available) noexcept;

    handle handle_;
    stream_setup setup_;
    std::vector<std::byte> wide_; ///< a buffer of the PCM's frames, where these have more channels
    status status_;
    detail::pacer pacer_;
    std::size_t max_descriptors_;
    std::uint64_t written_ = 0;
    std::uint64_t played_ = 0;
    std::int64_t seen_ns_ = 0;   ///< when the stream was last seen running
    std::int64_t dry_ns_ = 0;    ///< when it runs dry, as seen then
    std::int64_t looked_ns_ = 0; ///< when its position was last asked for, ...
    std::int64_t at_ = 0;        ///< ... which was this
    bool went_round_ = false;    ///< since prepare()
    bool on_card_ = false;
    bool paced_ = false;
    int poll_error_ = 0; ///< of the latest descriptors()
};

/// Returns what a state alone means for the stream; a negative value is an error number (a device that is
/// gone).
io_kind of_state(int state) noexcept;

/// Returns what a negative return value in a state means for the stream.
io_kind of_error(long code, int state) noexcept;

} // namespace tactor::pcm
