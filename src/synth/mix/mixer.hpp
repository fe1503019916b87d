// SPDX-License-Identifier: MIT
/// \file
/// The mixer: it turns drives into interleaved frames. The offline renderer and the audio thread use it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <tactor/choices.hpp>

#include "synth/limits/guard.hpp"
#include "synth/wave/event.hpp"

namespace tactor::synth {

/// Counts of what a mixer's limits changed.
struct mixer_counts {
    std::uint64_t limited = 0;       ///< number of samples that their channel's limit changed
    std::uint64_t power_limited = 0; ///< frames in which the limit on the summed power acted
    std::uint64_t drives_cut = 0; ///< drives cut short or silenced, because a channel was driven for too long
};

/// Mixer that sums drives, limits each channel, converts and interleaves. Frames count from the construction
/// or the last reset(). After construction nothing allocates, throws or blocks. The time for a block is
/// bounded by the number of channels and of drives that sound in it.
class mixer {
public:
    /// Makes a mixer. `limits`: maximum absolute value of each channel, linear, 0 to 1; the size is the
    /// number of channels. A channel with limit 0 has no tactor: only drives without a carrier sound there,
    /// and such drives sound nowhere else. `capacity`: number of drives that may wait or sound at once.
    /// `guards`: limits on the power of all channels together and on the drive time of each channel.
    mixer(std::span<const double> limits, format_kind format, std::size_t capacity = 8192,
          const guard_settings& guards = {});
    ~mixer();

    /// Returns the number of drives that can be added now.
    std::size_t available() const noexcept;

    /// Adds a drive. Drives may come in any order. A late drive begins at once, with the place and the phase
    /// that it would have now. Returns false if there is no space; try again later.
    bool add(const drive_event& e) noexcept;

    /// Renders the next frames. Samples depend on the drives only, not on block sizes.
    void process(std::size_t frames, std::byte* out) noexcept;

    /// Fades all drives of a score to zero within `fade` frames (0: cuts them) from the next frame on, and
    /// forgets them. While the fade runs, drops further drives of the score. After the fade the mixer no
    /// longer knows the score, so the caller must not add drives of it. Returns false if 256 fades are
    /// running already.
    bool fade_out(std::uint32_t score, std::uint32_t fade) noexcept;

    /// Moves the gain of a score's present and future drives linearly to `gain` (0 to 1) within `ramp` frames
    /// from the next frame on. The gain is 1 before the first call. Limits that use only amplitudes ignore
    /// the gain. Returns false if 512 scores have a gain already.
    bool set_gain(std::uint32_t score, double gain, std::uint32_t ramp) noexcept;
    /// Forgets the gain of a score that has ended.
    void forget_gain(std::uint32_t score) noexcept;

    /// Returns the number of frames in which a channel was driven so far; 0 if drive time is not counted.
    std::uint64_t driven(std::size_t channel) const noexcept;
    /// Raises a channel's level of drive time to `level_s`, a level in seconds that other programs have
    /// reached, from the next frame on.
    void raise(std::size_t channel, double level_s) noexcept;

    /// Drops all drives at once. Keeps the levels of drive time.
    void cut() noexcept;
    /// Drops all drives at once and begins a new epoch: frames count from 0. Keeps the levels of drive time.
    void reset() noexcept;

    /// Returns the next frame.
    std::uint64_t position() const noexcept;
    /// Returns the number of drives that wait or sound.
    std::size_t size() const noexcept;
    /// Returns how often each limit has acted so far.
    mixer_counts counts() const noexcept;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor::synth
