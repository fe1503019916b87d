// SPDX-License-Identifier: MIT
/// \file
/// The last guard of a tactor.
#pragma once

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

} // namespace tactor::synth
