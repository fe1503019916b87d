// SPDX-License-Identifier: MIT
/// \file
/// Times at which frames of the stream are at the DAC, in CLOCK_MONOTONIC. Pure: it takes readings and
/// returns a line.
#pragma once

#include <cstdint>

namespace tactor::engine {

/// A line of stream frames against time. Holds for its epoch only.
struct clock_line {
    std::uint64_t epoch = 0;   ///< number of the start of the DAC, from 1
    std::uint64_t first = 0;   ///< stream frame at which the epoch began
    std::uint64_t frame = 0;   ///< stream frame ...
    std::int64_t time_ns = 0;  ///< ... that is at the DAC at this time
    double ns_per_frame = 0.0; ///< 0: not known yet

    bool valid() const noexcept { return ns_per_frame > 0.0; }
    /// Returns the CLOCK_MONOTONIC time at which a frame is (was, will be) at the DAC. Only if valid.
    std::int64_t time_at(std::uint64_t stream_frame) const noexcept;
    /// Returns the frame nearest to a time; 0 for times before the stream. Only if valid.
    std::uint64_t frame_at(std::int64_t time) const noexcept;
};

/// A clock that follows the DAC: a Kalman filter of two states (time, drift). At first it is a least-squares
/// line, later a second-order DLL with a time constant of about a minute. Tests hold these bounds, with one
/// reading a ms, errors of up to 1 ms either way and a drift of up to 1000 ppm: within 0.5 ms after 0.1 s,
/// within 0.1 ms after 5 s. If the position moves by whole periods, only the first reading of each new
/// position counts. The line is then late by the mean time between the device's interrupt and the reading.
class dac_clock {
public:
    /// Starts without readings. `batch_frames`: steps of the position; 0 if it moves frame by frame.
    dac_clock(unsigned rate, unsigned batch_frames) noexcept;

    /// Begins an epoch when the DAC starts again: later readings belong to stream frames from `first` on.
    void begin_epoch(std::uint64_t first) noexcept;
    /// Adds a reading: stream frame `frame` was at the DAC at `time_ns`. Ignores a frame that is not beyond
    /// the latest, and a reading far off the line. After eight such readings in a row the line begins anew.
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
    unsigned in_a_row_ = 0; ///< readings that were ignored in a row
};

} // namespace tactor::engine
