// SPDX-License-Identifier: MIT
/// \file
/// The user's own samples as the mixer reads them: unchanged, with an envelope for the limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/waveform.hpp>

namespace tactor::synth {

/// A channel of the user's own samples. Samples are read in a unit that is a power of two, so that a product
/// with the unit restores each sample bit for bit.
struct own_channel {
    std::shared_ptr<const own_samples> all;
    unsigned channel = 0;
    double peak = 0.0;  ///< greatest absolute value
    double unit = 1.0;  ///< smallest power of two that is not below the peak
    double power = 1.0; ///< like timbre::power, for a wave with this peak
    std::size_t step = 1;
    std::vector<double> squares = {}; ///< squared envelope in units, one for each `step` frames

    /// Computes out[j], the sample of frame first + j, in units; 0 outside the samples.
    void read(std::int64_t first, unsigned n, double* out) const noexcept;
    /// Replaces x[j], which read() gives, by the y that completes the envelope: x^2 + y^2 = envelope^2.
    void complete_envelope(std::int64_t first, unsigned n, double* x) const noexcept;
    /// Returns the envelope in units at a frame of the samples.
    double envelope(std::uint64_t frame) const noexcept;
};

/// Returns the number of whole frames.
std::uint64_t count_frames(const own_samples& s) noexcept;

/// Returns half of the step between two values of a format: the maximum error of rounding; 0 for floats.
double half_step(format_kind f) noexcept;

/// Returns all channels.
/// \throws error (bad_input) for a sample that is not finite.
std::vector<own_channel> read_channels(const std::shared_ptr<const own_samples>& all);

/// Returns an error about the samples, which names their file, if any.
error bad_samples(const own_samples& s, std::string_view why, std::string_view hint);

} // namespace tactor::synth
