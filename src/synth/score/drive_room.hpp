// SPDX-License-Identifier: MIT
/// \file
/// When a piece may begin so that the limit on the time of a drive leaves it as it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactor/render.hpp>

namespace tactor::synth {

/// Keeps the levels of drive time of an array that is given pieces, as the mixer's drive_guard does, and a
/// little more strictly: a drive counts from its first frame to its last, and from half the amplitude on. So
/// what has room here is not cut there, unless somebody else drives the array, too. Control side, one thread
/// at a time.
class drive_room {
public:
    /// \throws error (bad_input) for impossible limits.
    drive_room(std::size_t channels, const drive_limits& l, unsigned rate);

    /// Returns the frames that a piece has to wait from frame `clock` on. None where it would be cut on an
    /// array that has rested.
    std::optional<std::uint64_t> wait(const score& s, std::uint64_t clock) const;

    /// Takes note of a score that was played from this frame on. Scores come in order of time.
    void played(const score& s, std::uint64_t clock);

    /// Time in which a tactor that was driven for as long as it may rests completely, s; 0 without a limit.
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

} // namespace tactor::synth
