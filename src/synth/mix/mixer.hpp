// SPDX-License-Identifier: MIT
/// \file
/// The mixer: drives in, interleaved frames out. Used by the offline renderer and by the audio thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/choices.hpp>

#include "synth/guard/drive_history.hpp"
#include "synth/guard/guard.hpp"
#include "synth/score/event.hpp"

namespace tactor::synth {

/// Sums drives, limits each channel, converts and interleaves. Frames are counted from 0 or from the last
/// reset(). After construction nothing allocates, throws or blocks; the cost of a block is bounded by the
/// channels and the drives that sound in it.
class mixer {
public:
    /// `limits`: greatest absolute value of each channel, linear, 0 ... 1; its size is the channel count.
    /// `capacity`: drives that may wait or sound at once. A channel whose limit is 0 has no tactor: markers
    /// sound on it, and nothing else does. Markers sound nowhere else. `guards` limit the power of all
    /// channels together and the time of each.
    mixer(std::span<const double> limits, format_kind format, std::size_t capacity = 8192,
          const guard_settings& guards = {});
    ~mixer();

    std::size_t channels() const noexcept;
    /// Drives that can be added now.
    std::size_t available() const noexcept;

    /// Adds a drive; they may come in any order. A drive whose start has passed begins at once, in its middle
    /// (with the right phase). False when there is no space: the drive was not added, try again later.
    bool add(const drive_event& e) noexcept;

    /// Renders the next frames. Same drives, same samples, whatever the block sizes.
    void process(std::size_t frames, std::byte* out) noexcept;

    /// Fades all drives of a score to zero, from the next frame on, in `fade` frames (0: cut), and forgets
    /// them. Drives of that score that are added while the fade runs are dropped. Once it has ended, the
    /// mixer does not know of it any more, so the caller must stop adding such drives. False if 256 fades run
    /// already.
    bool fade_out(std::uint32_t score, std::uint32_t fade) noexcept;

    /// For how long each channel was driven lately, for the next mixer of the same array. Allocates; nobody
    /// may be in process().
    drive_history history() const;
    /// Goes on from the history of another mixer, at any rate; call drive_history::pass() for the time that
    /// went by meanwhile. Only before the first process(). Allocates nothing.
    void resume(const drive_history& h) noexcept;

    /// Drops everything at once and counts frames from 0: a new epoch. For how long the channels were driven
    /// before still counts.
    void reset() noexcept;

    /// Next frame.
    std::uint64_t position() const noexcept;
    /// Drives that wait or sound.
    std::size_t size() const noexcept;
    /// Samples that the limiter changed so far.
    std::uint64_t limited() const noexcept;
    /// Frames in which the limit on the summed power acted.
    std::uint64_t power_limited() const noexcept;
    /// How many drives were cut short or silenced because their channel was driven for too long.
    std::uint64_t drives_cut() const noexcept;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

/// The limits of an array's channels (10^(max_dbfs / 20)) for `channels` channels; channels without a tactor:
/// 0.
std::vector<double> channel_limits(const array& a, unsigned channels);

} // namespace tactor::synth
