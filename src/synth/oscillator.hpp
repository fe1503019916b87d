// SPDX-License-Identifier: MIT
/// \file
/// Carriers block by block: one exact angle a block, the rest by angle addition from a table, so no error
/// piles up however long the carrier runs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "synth/sincos.hpp"

namespace tactor::synth {

/// Frames of a block. Blocks lie at multiples of it in the stream, whatever the sizes that are asked for.
inline constexpr unsigned block_frames = 64;

using block = std::array<double, block_frames>;

/// Sine and cosine of the first frames of one frequency.
struct oscillator_table {
    alignas(32) block sin;
    alignas(32) block cos;
};

/// The tables of the frequencies in use: a few places for each by its bits; a new one takes the place of the
/// oldest there.
class oscillator_tables {
public:
    oscillator_tables();
    /// Valid until the next call.
    const oscillator_table& get(double cycles_per_frame) noexcept;

private:
    static constexpr std::size_t rows = 64;
    static constexpr std::size_t places = 4;
    struct row {
        std::array<double, places> keys;
        std::size_t oldest = 0;
    };
    std::array<row, rows> rows_;
    std::vector<oscillator_table> tables_;
};

/// out[j] = sin(2 pi (base + j f)) for lo <= j < hi; `base` is the angle of j = 0 and `t` f's table.
void sine_block(const oscillator_table& t, sine_cosine base, unsigned lo, unsigned hi, double* out) noexcept;

/// out[j] *= offset + scale * cos(2 pi (base + j f)) for lo <= j < hi: both halves of a raised cosine.
void times_cosine(const oscillator_table& t, sine_cosine base, double offset, double scale, unsigned lo,
                  unsigned hi, double* out) noexcept;

}  // namespace tactor::synth
