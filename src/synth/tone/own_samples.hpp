// SPDX-License-Identifier: MIT
/// \file
/// One's own samples as the mixer reads them: as they are, with an envelope for the limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/waveform.hpp>

namespace tactor::synth {

/// A channel of one's own samples. Read in a unit that is a power of two, so that a product with it is the
/// sample again, in all its bits.
struct own_channel {
    std::shared_ptr<const own_samples> all;
    unsigned channel = 0;
    double peak = 0.0;  ///< greatest absolute value
    double unit = 1.0;  ///< the power of two from the peak up
    double power = 1.0; ///< as timbre::power, of a wave with this peak
    std::size_t step = 1;
    std::vector<double> squares = {}; ///< square of the envelope in units, for each `step` frames

    /// Computes out[j], frame first + j in units; 0 outside of the samples.
    void read(std::int64_t first, unsigned n, double* out) const noexcept;
    /// Replaces x[j], what read() gives, by what completes the envelope: x^2 + y^2 = envelope^2.
    void complete_envelope(std::int64_t first, unsigned n, double* x) const noexcept;
    /// Returns the envelope in units at a frame of the samples.
    double envelope(std::uint64_t frame) const noexcept;
};

/// Returns the number of whole frames.
std::uint64_t count_frames(const own_samples& s) noexcept;

/// Returns half of the step between two samples of a format: what rounding to it may add; 0 for floats.
double half_step(format_kind f) noexcept;

/// Returns all channels.
/// \throws error (bad_input) for a sample that is not finite.
std::vector<own_channel> read_channels(const std::shared_ptr<const own_samples>& all);

/// Returns an error about the samples, which names their file, if any.
error bad_samples(const own_samples& s, std::string_view why, std::string_view hint);

} // namespace tactor::synth
