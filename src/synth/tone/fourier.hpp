// SPDX-License-Identifier: MIT
/// \file
/// Fourier sums for tables of waves; when a score is made, never in the audio thread. The same bits on every
/// machine.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace tactor::synth {

using spectrum = std::vector<std::complex<double>>;

/// x[n] = sum over k of x[k] exp(2 pi i k n / size), in place; the size is a power of 2.
void fourier_sum(spectrum& x);

/// The first `count` coefficients c[k] = sum over n of x[n] exp(-2 pi i k n / size) / size of any number of
/// samples.
spectrum fourier_coefficients(std::span<const float> x, std::size_t count);

} // namespace tactor::synth
