// SPDX-License-Identifier: MIT
/// \file
/// A configured PCM as a sink. adopt() makes a sink of a PCM that is already open, for tests that simulate a
/// device.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <alsa/asoundlib.h>

#include <tactor/alsa.hpp>
#include <tactor/sink.hpp>

#include "sink/alsa/handle.hpp"
#include "sink/pacer.hpp"

namespace tactor::alsa {

/// A sink that writes with snd_pcm_writei(). If start() shows that a device has no clock, a timer paces it.
///
/// A card plays its buffer in a loop, and reports its place in the buffer to the kernel. If nothing reads
/// this place during a whole loop (interrupts were off, the processor or the machine stood still), the
/// position does not include that loop, and the kernel reports no xrun. So this sink reports an xrun itself
/// if the position of a moving stream was not read during a whole loop.
class pcm_sink final : public sink {
public:
    /// Takes over a PCM. `on_card`: it plays on a sound card of the kernel.
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
    void arrange_frames(std::span<const std::byte> frames) noexcept;
    long hand_over(std::span<const std::byte> frames) noexcept;
    long write_paced_frames(std::span<const std::byte> frames) noexcept;
    bool runs_without_clock() noexcept;
    std::int64_t frames_to_ns(std::uint64_t frames) const noexcept;
    void look(std::int64_t now, snd_pcm_sframes_t available) noexcept;

    handle handle_;
    stream_setup setup_;
    std::vector<std::byte> arranged_; ///< buffer in the PCM's layout, if that is planar or has more channels
    std::vector<void*> planes_;       ///< the channels in `arranged_`, if it is planar
    status status_;
    detail::pacer pacer_;
    std::size_t max_descriptors_;
    std::uint64_t written_ = 0;
    std::uint64_t played_ = 0;
    std::int64_t seen_ns_ = 0;   ///< time when the stream was last seen running
    std::int64_t dry_ns_ = 0;    ///< time when the stream will run dry, as predicted at seen_ns_
    std::int64_t looked_ns_ = 0; ///< time when the position was last read
    std::int64_t at_ = 0;        ///< position at looked_ns_
    bool went_round_ = false;    ///< since prepare(), a whole loop has passed unread
    bool on_card_ = false;
    bool paced_ = false;
    int poll_error_ = 0; ///< error of the latest descriptors()
};

/// Returns the outcome of a call that returned a negative value, for a state of the PCM.
io_kind classify_error(long code, int state) noexcept;

/// Configures `p` and takes it over; closes it if that fails. Throws as open_alsa() does; `o.pcm` is only a
/// name. `as_card`: treats the clock of `p` as a card's, which never waits for this process. `device`: value
/// of stream_setup::device.
std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o, bool as_card = false,
                            std::string_view device = {});

} // namespace tactor::alsa
