// SPDX-License-Identifier: MIT
/// \file
/// Drive time and power of a whole score: how long it must wait so that no drive is cut, and whether its
/// power is limited.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactor/render.hpp>

namespace tactor::synth {

/// Levels of drive time of an array that plays pieces. Counts like the mixer's drive_guard, but a little
/// stricter: a drive counts from its first frame to its last, and from half the amplitude on. The guard
/// therefore does not cut a piece that begins after wait(), unless another program also drives the array.
/// Control side, one thread at a time.
class drive_room {
public:
    /// \throws error (bad_input) for impossible limits.
    drive_room(std::size_t channels, const drive_limits& l, unsigned rate);

    /// Returns the number of frames that a piece must wait from frame `clock` on; nothing if the guard would
    /// cut it even on a rested array.
    std::optional<std::uint64_t> wait(const score& s, std::uint64_t clock) const;

    /// Sets the levels, s, at frame 0. Ignores levels of channels that do not exist.
    void resume(std::span<const double> levels_s);

    /// Marks all channels as closed by the guard at a frame, because an unknown program drove them. The guard
    /// opens a channel at half of the limit.
    void close(std::uint64_t clock);

    /// Adds a score that was played from this frame on. Call it in order of time.
    void add_played_score(const score& s, std::uint64_t clock);

    /// Returns the time after which a tactor at the limit has rested completely, s; 0 without a limit.
    double rest_s() const noexcept { return limit_ / leak_ / rate_; }

private:
    /// Level of a channel at frame `at`, in frames.
    struct level {
        double frames = 0.0;
        std::uint64_t at = 0;
    };
    double level_at(std::size_t channel, std::uint64_t clock) const noexcept;

    std::vector<level> levels_; ///< empty without a limit
    double limit_ = 0.0;
    double leak_ = 1.0;
    unsigned rate_;
};

/// Returns true if the score's own limit on power changes its samples. Renders the score, unless its tactors
/// together stay below the limit even at their loudest.
bool is_power_limited(const score& s);

} // namespace tactor::synth
