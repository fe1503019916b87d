// SPDX-License-Identifier: MIT
/// \file
/// Stands in for the queue that a device without a clock does not have.
#pragma once

#include <cstdint>

namespace tactor::detail {

/// Frames that leave at the sample rate, in pure arithmetic: the time comes from outside. Deadlines are
/// counted from one origin, so nothing drifts. Where the writer comes too late the clock waits for it
/// (the origin moves): nothing is lost where there is no DAC. All times CLOCK_MONOTONIC ns.
class virtual_queue {
public:
    virtual_queue(unsigned rate, unsigned buffer_frames) noexcept : rate_(rate), buffer_(buffer_frames) {}

    /// Frame 0 leaves at `now`.
    void start(std::int64_t now, std::uint64_t written) noexcept;
    void wrote(std::uint64_t frames) noexcept { written_ += frames; }

    std::uint64_t written() const noexcept { return written_; }
    /// Frames that have left.
    std::uint64_t played(std::int64_t now) noexcept;
    /// Frames that fit.
    std::uint64_t available(std::int64_t now) noexcept;
    /// First time at which `frames` frames fit (frames <= the buffer).
    std::int64_t time_of_room(std::uint64_t frames) const noexcept;

private:
    std::int64_t duration(std::uint64_t frames) const noexcept;

    std::uint64_t rate_;
    std::uint64_t buffer_;
    std::uint64_t written_ = 0;
    std::int64_t origin_ = 0;
};

} // namespace tactor::detail
