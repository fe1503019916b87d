// SPDX-License-Identifier: MIT
/// \file
/// Samples behind a timbre, and the Fourier sums for them. They are computed when a score is made, never in
/// the audio thread.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactor/waveform.hpp>

#include "synth/tone/timbre.hpp"

namespace tactor::synth {

/// Most harmonics of a cycle: in a slow cycle nothing above them is felt.
inline constexpr std::size_t most_harmonics = 4096;

/// Returns a square, triangle or sawtooth of harmonics 1 to `harmonics`, with a peak of 1, as read_cycle()
/// needs it.
wave_samples shape_cycle(waveform_kind shape, std::size_t harmonics);

/// Returns one cycle of recorded samples, with at most `harmonics` harmonics, without its mean, and with a
/// peak of 1.
/// \throws error (bad_input) if nothing is left.
wave_samples recorded_cycle(const recording& r, std::size_t harmonics);

/// Returns noise that repeats after some 5 s, only between low_hz and high_hz; its peak is 1.
wave_samples noise_loop(double low_hz, double high_hz, std::uint64_t seed, unsigned rate);

/// Returns a recording in its own time at another rate; its peak is 1, and its mean 0.
/// \throws error (bad_input) if nothing is left.
wave_samples recorded_loop(const recording& r, unsigned rate);

/// Returns twice the mean square, but at least 1.
double wave_power(const wave_samples& x) noexcept;

using spectrum = std::vector<std::complex<double>>;

/// Computes x[n] = sum over k of x[k] exp(2 pi i k n / size), in place; the size is a power of 2. Equal bits
/// on every machine.
void fourier_sum(spectrum& x);

/// Returns the first `count` coefficients c[k] = sum over n of x[n] exp(-2 pi i k n / size) / size of any
/// number of samples.
spectrum fourier_coefficients(std::span<const float> x, std::size_t count);

} // namespace tactor::synth
