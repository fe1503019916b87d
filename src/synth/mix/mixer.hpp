// SPDX-License-Identifier: MIT
/// \file
/// The mixer: it takes drives and gives interleaved frames. The offline renderer and the audio thread use it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <tactor/choices.hpp>

#include "synth/guard.hpp"
#include "synth/score/event.hpp"

namespace tactor::synth {

/// Work of a mixer's limits.
struct mixer_counts {
    std::uint64_t limited = 0;       ///< samples that the limit of their channel changed
    std::uint64_t power_limited = 0; ///< frames in which the limit on the summed power acted
    std::uint64_t drives_cut = 0; ///< drives cut short or silenced, because a channel was driven for too long
};

/// Sums drives, limits each channel, converts and interleaves. Frames count from 0 or from the last reset().
/// After construction nothing allocates, throws or blocks. The cost of a block is bounded by the channels and
/// the drives that sound in it.
class mixer {
public:
    /// Makes a mixer. `limits`: greatest absolute value of each channel, linear, 0 ... 1; its size is the
    /// channel count. `capacity`: drives that may wait or sound at once. A channel whose limit is 0 has no
    /// tactor: markers sound on it, and nothing else does. Markers sound nowhere else. `guards` limit the
    /// power of all channels together and the time of each.
    mixer(std::span<const double> limits, format_kind format, std::size_t capacity = 8192,
          const guard_settings& guards = {});
    ~mixer();

    /// Returns the number of drives that can be added now.
    std::size_t available() const noexcept;

    /// Adds a drive. Drives may come in any order. A drive whose start has passed begins at once, in its
    /// middle (with the right phase). Returns false without adding it if there is no space; try again later.
    bool add(const drive_event& e) noexcept;

    /// Renders the next frames. Samples depend on the drives only, not on block sizes.
    void process(std::size_t frames, std::byte* out) noexcept;

    /// Fades all drives of a score to zero, from the next frame on, in `fade` frames (0: cut), and forgets
    /// them. Drops drives of that score that are added while the fade runs. Once it has ended, the mixer has
    /// forgotten the score, so the caller must stop adding such drives. Returns false if 256 fades run
    /// already.
    bool fade_out(std::uint32_t score, std::uint32_t fade) noexcept;

    /// Leads the factor of all drives of a score, those to come too, linearly to `gain` (0 ... 1), within
    /// `ramp` frames from the next one on; until then it is 1. The limits still count with the drives' full
    /// amplitudes where they look at amplitudes alone. Returns false if 512 scores have one already.
    bool set_gain(std::uint32_t score, double gain, std::uint32_t ramp) noexcept;
    /// Forgets the factor of a score that has ended.
    void forget_gain(std::uint32_t score) noexcept;

    /// Returns the frames in which a channel was driven so far; 0 where drive time is not counted.
    std::uint64_t driven(std::size_t channel) const noexcept;
    /// Raises a channel to a level of drive time, s, that others have driven it to, from the next frame on.
    void raise(std::size_t channel, double level_s) noexcept;

    /// Drops everything at once. Drive times still count.
    void cut() noexcept;
    /// Drops everything at once and counts frames from 0: a new epoch. Drive times still count.
    void reset() noexcept;

    /// Returns the next frame.
    std::uint64_t position() const noexcept;
    /// Returns the number of drives that wait or sound.
    std::size_t size() const noexcept;
    /// Returns what the limits changed so far.
    mixer_counts counts() const noexcept;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor::synth
