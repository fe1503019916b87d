// SPDX-License-Identifier: MIT
/// \file
/// A configured PCM as a sink, and sinks of PCMs that are already open, for devices that live in the test
/// itself.
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
/// A card plays its buffer round and round, and tells the kernel its place in the buffer. If no process reads
/// this place during a whole round (interrupts were off, the processor or the machine stood still), the round
/// is missing from the position, and no xrun is reported. So this sink reports an xrun for a stream that
/// moved and whose position was not read during a whole round, whatever the kernel says.
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
    void arrange(std::span<const std::byte> frames) noexcept;
    long hand_over(std::span<const std::byte> frames) noexcept;
    long write_paced(std::span<const std::byte> frames) noexcept;
    bool runs_without_clock() noexcept;
    std::int64_t frames_to_ns(std::uint64_t frames) const noexcept;
    void look(std::int64_t now, snd_pcm_sframes_t available) noexcept;

    handle handle_;
    stream_setup setup_;
    std::vector<std::byte> arranged_; ///< a buffer as the PCM takes it, if it is planar or has more channels
    std::vector<void*> planes_;       ///< the channels in `arranged_`, if it is planar
    status status_;
    detail::pacer pacer_;
    std::size_t max_descriptors_;
    std::uint64_t written_ = 0;
    std::uint64_t played_ = 0;
    std::int64_t seen_ns_ = 0;   ///< time when the stream was last seen running
    std::int64_t dry_ns_ = 0;    ///< time when it runs dry, as predicted then
    std::int64_t looked_ns_ = 0; ///< time when its position was last read, ...
    std::int64_t at_ = 0;        ///< ... and that position
    bool went_round_ = false;    ///< since prepare()
    bool on_card_ = false;
    bool paced_ = false;
    int poll_error_ = 0; ///< error of the latest descriptors()
};

/// Returns the outcome that a negative return value means in a state.
io_kind classify_error(long code, int state) noexcept;

/// Configures `p` and owns it; closes it on failure, too. Throws as open_alsa() does; `o.pcm` is only a name.
/// `as_card`: treats its clock as a card's, which never stops for this process. `device`: as
/// stream_setup::device.
std::unique_ptr<sink> adopt(snd_pcm_t* p, const alsa_options& o, bool as_card = false,
                            std::string_view device = {});

} // namespace tactor::alsa
