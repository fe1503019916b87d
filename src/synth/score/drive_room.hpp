// SPDX-License-Identifier: MIT
/// \file
/// Limits on drive time and power for a whole score: the wait after which no drive is cut, and a test if its
/// power is limited.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactor/render.hpp>

namespace tactor::synth {

/// Levels of drive time of an array that plays pieces, as in the mixer's drive_guard, but a little stricter:
/// a drive counts from its first frame to its last, and from half the amplitude on. So the guard does not cut
/// a piece for which this has room, unless another program also drives the array. Control side, one thread at
/// a time.
class drive_room {
public:
    /// \throws error (bad_input) for impossible limits.
    drive_room(std::size_t channels, const drive_limits& l, unsigned rate);

    /// Returns the frames that a piece must wait from frame `clock` on; nothing if the guard would cut it
    /// even on a rested array.
    std::optional<std::uint64_t> wait(const score& s, std::uint64_t clock) const;

    /// Begins with these levels, s, at frame 0; nothing for channels beyond.
    void resume(std::span<const double> levels_s);

    /// Marks all channels as closed by the guard at a frame, which opens them at half of the limit, because
    /// an unknown program drove them.
    void close(std::uint64_t clock);

    /// Adds a score that was played from this frame on. Scores come in order of time.
    void played(const score& s, std::uint64_t clock);

    /// Returns the time in which a tactor at the limit rests completely, s; 0 without a limit.
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
bool power_acts(const score& s);

} // namespace tactor::synth
