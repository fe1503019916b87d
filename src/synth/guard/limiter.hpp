// SPDX-License-Identifier: MIT
/// \file
/// The last guard of a tactor.
#pragma once

#include <algorithm>
#include <cstdint>

namespace tactor::synth {

/// Holds n samples within -limit ... limit; what is not a number becomes 0. Returns how many it changed, not
/// counting an excess of rounding noise.
std::uint64_t limit_block(double* x, unsigned n, double limit) noexcept;

/// Whether samples of at most `peak` cannot be changed by limit_block. Not a number: false.
inline bool within_limit(double peak, double limit) noexcept
{
    return peak <= limit * (1.0 - 1e-12);
}

/// The limit as given, but nothing outside 0 ... 1.
inline double clean_limit(double l) noexcept
{
    return l > 0.0 ? std::min(l, 1.0) : 0.0;
}

} // namespace tactor::synth
