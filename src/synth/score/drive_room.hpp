// SPDX-License-Identifier: MIT
/// \file
/// When a piece may begin so that the limit on the time of a drive leaves it as it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactor/render.hpp>

#include "synth/guard/drive_guard.hpp"
#include "synth/guard/guard.hpp"

namespace tactor::synth {

/// Keeps a book of the pieces that an array was given, as the mixer's drive_guard does, and a little more
/// strictly: a drive counts from its first frame to its last, and from half the amplitude on. So what has
/// room here is not cut there, unless somebody else drives the array, too. Control side, one thread at a
/// time.
class drive_room {
public:
    /// \throws error (bad_input) for impossible limits.
    drive_room(std::size_t channels, const drive_limits& l, unsigned rate);

    /// Frames that a piece has to wait from frame `clock` on; at most a window, and up to 50 ms more than
    /// needed. None where it would be cut on an array that has rested.
    std::optional<std::uint64_t> wait(const score& s, std::uint64_t clock) const;

    /// Takes note of a score that was played from this frame on. Scores come in order of time.
    void played(const score& s, std::uint64_t clock);

    /// Time in which all drive leaves the limit's window, s; 0 without a limit.
    double window_s() const noexcept { return static_cast<double>(window_) / rate_; }

private:
    drive_room(std::size_t channels, const guard_settings& g);

    drive_guard guard_;
    std::uint64_t window_;
    unsigned rate_;
};

} // namespace tactor::synth
