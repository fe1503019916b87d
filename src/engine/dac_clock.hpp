// SPDX-License-Identifier: MIT
/// \file
/// Clock that tells when each frame of the stream is at the DAC, in CLOCK_MONOTONIC. Pure: it takes readings
/// and returns a line.
#pragma once

#include <cstdint>

namespace tactor::engine {

/// Linear relation between stream frames and time. Valid only in its epoch.
struct clock_line {
    std::uint64_t epoch = 0;   ///< number of this start of the DAC; the first is 1
    std::uint64_t first = 0;   ///< stream frame at which the epoch began
    std::uint64_t frame = 0;   ///< stream frame at the DAC at time_ns
    std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC
    double ns_per_frame = 0.0; ///< 0 if not known yet

    bool valid() const noexcept { return ns_per_frame > 0.0; }
    /// Returns the CLOCK_MONOTONIC time at which a frame is (was, will be) at the DAC. Precondition: valid().
    std::int64_t time_at(std::uint64_t stream_frame) const noexcept;
    /// Returns the frame nearest to a time; 0 for times before the stream. Precondition: valid().
    std::uint64_t frame_at(std::int64_t time) const noexcept;
};

/// A clock that follows the DAC: a Kalman filter with two states (time, drift). It starts as a least-squares
/// fit and becomes a second-order delay-locked loop with a time constant of about a minute. The tests check
/// that the error is below 0.5 ms after 0.1 s and below 0.1 ms after 5 s, with one reading per ms, reading
/// errors of up to 1 ms and a drift of up to 1000 ppm. If the position moves by whole periods, only the first
/// reading of each new position counts. The clock is then late by the mean time between the device's
/// interrupt and the reading.
class dac_clock {
public:
    /// Starts without readings. `batch_frames`: frames by which the position jumps; 0 if it moves frame by
    /// frame.
    dac_clock(unsigned rate, unsigned batch_frames) noexcept;

    /// Begins an epoch when the DAC starts again: later readings belong to stream frames from `first` on.
    void begin_epoch(std::uint64_t first) noexcept;
    /// Adds a reading: stream frame `frame` was at the DAC at `time_ns`. Ignores a frame that is not later
    /// than the latest one, and a reading that is far off the line. Starts a new line after eight such
    /// outliers in a row.
    void add(std::int64_t time_ns, std::uint64_t frame) noexcept;

    const clock_line& line() const noexcept { return line_; }

private:
    void begin_line(std::int64_t time_ns, std::uint64_t frame) noexcept;

    double nominal_; ///< ns per frame
    double noise_;   ///< variance of a reading, ns^2
    clock_line line_;
    double fraction_ = 0.0; ///< fraction of a ns, added to line_.time_ns
    double drift_ = 0.0;    ///< ns per ns
    double p_time_ = 0.0;   ///< covariance
    double p_cross_ = 0.0;
    double p_drift_ = 0.0;
    unsigned in_a_row_ = 0; ///< consecutive readings that were far off
};

} // namespace tactor::engine
