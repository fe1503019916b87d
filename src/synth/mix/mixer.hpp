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

/// Work of a mixer's limits.
struct mixer_counts {
    std::uint64_t limited = 0;       ///< samples that the limit of their channel changed
    std::uint64_t power_limited = 0; ///< frames in which the limit on the summed power acted
    std::uint64_t drives_cut = 0; ///< drives cut short or silenced, because a channel was driven for too long
};

/// Mixer that sums drives, limits each channel, converts and interleaves. Frames count from 0 or from the
/// last reset(). After construction nothing allocates, throws or blocks. The cost of a block is bounded by
/// the channels and the drives that sound in it.
class mixer {
public:
    /// Makes a mixer. `limits`: greatest absolute value of each channel, linear, 0 ... 1; its size is the
    /// channel count. `capacity`: drives that may wait or sound at once. A channel whose limit is 0 has no
    /// tactor: drives without a carrier sound on it, and nothing else does. They sound nowhere else. `guards`
    /// limit the power of all channels together and the time of each.
    mixer(std::span<const double> limits, format_kind format, std::size_t capacity = 8192,
          const guard_settings& guards = {});
    ~mixer();

    /// Returns the number of drives that can be added now.
    std::size_t available() const noexcept;

    /// Adds a drive. Drives may come in any order. A late drive begins at once, at its present place and
    /// phase. Returns false without adding it if there is no space; try again later.
    bool add(const drive_event& e) noexcept;

    /// Renders the next frames. Samples depend on the drives only, not on block sizes.
    void process(std::size_t frames, std::byte* out) noexcept;

    /// Fades all drives of a score to zero, from the next frame on, in `fade` frames (0: cut), and forgets
    /// them. Drops drives of that score that are added while the fade runs. Once it has ended, the mixer has
    /// forgotten the score, so the caller must stop adding such drives. Returns false if 256 fades run
    /// already.
    bool fade_out(std::uint32_t score, std::uint32_t fade) noexcept;

    /// Moves the factor of a score's present and future drives linearly to `gain` (0 ... 1) within `ramp`
    /// frames from the next one on; before the first call it is 1. Limits that use only amplitudes still see
    /// the full ones. Returns false if 512 scores have a factor already.
    bool set_gain(std::uint32_t score, double gain, std::uint32_t ramp) noexcept;
    /// Forgets the factor of a score that has ended.
    void forget_gain(std::uint32_t score) noexcept;

    /// Returns the number of frames in which a channel was driven so far; 0 if drive time is not counted.
    std::uint64_t driven(std::size_t channel) const noexcept;
    /// Raises a channel's level of drive time to that of others, s, from the next frame on.
    void raise(std::size_t channel, double level_s) noexcept;

    /// Drops everything at once. Drive times still count.
    void cut() noexcept;
    /// Drops everything at once and counts frames from 0: a new epoch. Drive times still count.
    void reset() noexcept;

    /// Returns the next frame.
    std::uint64_t position() const noexcept;
    /// Returns the number of drives that wait or sound.
    std::size_t size() const noexcept;
    /// Returns the counts of the limits so far.
    mixer_counts counts() const noexcept;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor::synth
