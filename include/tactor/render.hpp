// SPDX-License-Identifier: MIT
/// \file
/// From plans to samples (rendering model, section 7).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/plan.hpp>
#include <tactor/sample_format.hpp>

namespace tactor {

/// Where the carrier's phase starts. With `stroke` one carrier runs from the stroke's first frame on, and
/// bursts open and close it: a tactor that plays several in a row goes on without a break. With `burst` it
/// starts again with each (or with the first of those that overlap on a tactor), so that 17.5 cycles, as 70
/// ms at 250 Hz are, flip at each boundary: the line at 250 Hz splits into 242.9 and 257.1 Hz, with a mean
/// above 0.
enum class phase_mode { stroke, burst };

/// "stroke" or "burst".
TACTOR_API std::string_view to_string(phase_mode p) noexcept;

/// What the array may be given at run time, over and above each channel's own max_dbfs: what the channels
/// get after all strokes are summed, by its envelope. Plans within these limits are not touched in a single
/// bit. The defaults are safe guesses: know your actuators.
struct drive_limits {
    /// Greatest power of all tactors together, in dB above one channel's sine at full scale: the sum of the
    /// squared envelopes in every frame, where carriers beat on a tactor at their crests. Default: that of
    /// three; infinite: no limit. The gain of all falls within some 10 ms, without a click, and returns with
    /// 50 ms; what begins at once meanwhile fades in.
    double power_dbfs = 4.771212547196624;
    /// Longest time that one tactor is driven (above -40 dBFS) within any window; then its channel fades out
    /// until half of that time has left the window. No window holds more than this and one fade of 20 ms.
    /// What begins oftener than each 1/256 of the window may be cut so much early. Not below window_s: no
    /// limit.
    double max_drive_s = 5.0;
    double window_s = 10.0;
};

struct render_options {
    unsigned rate = 48000; ///< Hz, 8000 to 768000
    phase_mode phase = phase_mode::stroke;
    /// Raised-cosine ramp inside each burst, s, from 0. Default: 0 where the carrier crosses zero at the
    /// burst's begin and at its end (both within 1 % of a half cycle), else 2 ms; burst by burst.
    std::optional<double> ramp_s = {};
    double level_dbfs = -12.0;        ///< peak for amplitude 1, <= 0; a tactor's gain_db is added
    std::optional<double> sl_db = {}; ///< instead: dB above each tactor's threshold_dbfs
    unsigned channels = 0;            ///< 0: as many as the array needs
    /// Applied by the renderer; the player has its own. None: the piece as it was designed.
    std::optional<drive_limits> limits = {};
    /// A spare channel on which each stroke's first frames are marked, at full scale and to the frame: the
    /// sync signal that no scheduler can delay.
    std::optional<unsigned> marker_channel = {};
    double marker_s = 0.005; ///< above 0, at most 10 s
};

/// Ramp of a burst (or of a continuous stroke, whose onset is 0) in seconds: o.ramp_s, or the default. Both
/// ends of a burst that is shorter than two of them have half of it.
TACTOR_API double burst_ramp_s(double onset_s, double duration_s, double carrier_hz,
                               const render_options& o) noexcept;

/// A plan and when it starts.
struct placed_plan {
    plan schedule = {};
    /// Seconds from the start of the piece; none: at the end of the plan before it (the first: 0).
    std::optional<double> start_s = {};
};

/// Plans at a sample rate and at levels: frames and channels. Immutable, cheap to copy; a move is a copy, so
/// that what is moved from stays what it was.
class TACTOR_API score {
public:
    /// \throws error (bad_input): carrier at or above half the rate, a level that a tactor may not
    ///         have (above full scale or its max_dbfs; with its line in the array file), a tactor
    ///         without a threshold where a sensation level is asked for, too few channels.
    score(const array& a, std::vector<placed_plan> plans, const render_options& o);
    score(const score&) noexcept = default;
    score& operator=(const score&) noexcept = default;

    std::uint64_t frames() const noexcept; ///< length of the piece
    unsigned channels() const noexcept;
    unsigned rate() const noexcept; ///< Hz
    /// Start of each plan in frames.
    const std::vector<std::uint64_t>& starts() const noexcept;
    const std::vector<placed_plan>& plans() const noexcept;

    struct impl;
    const std::shared_ptr<const impl>& data() const noexcept; ///< for the library

private:
    std::shared_ptr<const impl> impl_;
};

/// Renders a score offline, block by block. The same mixer as in the player: same score, same
/// samples, whatever the block sizes. One thread at a time. What is moved from can be destroyed and assigned
/// to; its other members throw error (bad_input).
class TACTOR_API renderer {
public:
    renderer(const score& s, sample_format f);
    ~renderer();
    renderer(renderer&&) noexcept;
    renderer& operator=(renderer&&) noexcept;

    /// Writes `frames` interleaved frames to out (frames * channels * bytes_of(format) bytes) and
    /// goes on; silence after the end, and after a failure(). Allocates nothing.
    void process(std::size_t frames, std::byte* out);

    /// Next frame to be rendered.
    std::uint64_t position() const;

    /// Why the rest is silence: a plan's `at` threw, or gave what is no amplitude of a tactor, in mid-stroke.
    /// Empty while all is well.
    const std::string& failure() const;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor
