// SPDX-License-Identifier: MIT
/// \file
/// Carriers: an exact angle every 64 frames, the rest by angle addition from a table. No error accumulates,
/// however long the carrier runs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "synth/mix/sincos.hpp"

namespace tactor::synth {

/// Most frames that are mixed at once. Samples do not depend on the start of a block.
inline constexpr unsigned block_frames = 512;
/// Frames from one exact angle to the next.
inline constexpr unsigned table_frames = 64;

using block = std::array<double, block_frames>;

/// Parts of a carrier. Both give the envelope: sin^2 + cos^2 = 1 in each frame.
enum class wave : unsigned char { sine, cosine };

/// Sine and cosine of the first frames of one frequency.
struct oscillator_table {
    alignas(64) std::array<double, table_frames> sin;
    alignas(64) std::array<double, table_frames> cos;
};

/// Tables of the frequencies in use, up to 1024. The bits of a frequency select a few places. A new frequency
/// replaces one of them at random, not the oldest: if more frequencies take turns than there are places, the
/// oldest is needed next.
class oscillator_tables {
public:
    oscillator_tables();
    /// Returns the table of a frequency, valid until the next call.
    const oscillator_table& get(double cycles_per_frame) noexcept;

private:
    static constexpr std::size_t rows = 256;
    static constexpr std::size_t places = 4;
    static constexpr unsigned place_bits = 2;
    static_assert(places == 1U << place_bits);
    std::size_t place_for_new(const std::array<double, places>& keys) noexcept;

    std::array<std::array<double, places>, rows> keys_;
    std::uint32_t chance_ = 0;
    std::vector<oscillator_table> tables_;
};

/// Part of a block between two multiples of table_frames in a carrier's own frame count. `base` is the frame
/// of the lower multiple. Angle addition starts there, independent of blocks, so a stroke has the same
/// samples wherever it begins.
struct table_part {
    std::int64_t base = 0;
    unsigned lo = 0; ///< in the block
    unsigned hi = 0;
    unsigned offset = 0; ///< index of lo in the table
};

/// Calls f(table_part) for the parts of frames first + lo ... first + hi - 1.
template <class F>
void for_each_part(std::int64_t first, unsigned lo, unsigned hi, F f) noexcept
{
    while (lo < hi) {
        const std::int64_t k = first + lo;
        const auto offset = static_cast<unsigned>(static_cast<std::uint64_t>(k) % table_frames);
        const unsigned end = hi - lo < table_frames - offset ? hi : lo + table_frames - offset;
        f(table_part{k - offset, lo, end, offset});
        lo = end;
    }
}

/// Computes out[j] = sin(2 pi f (first + j)) for j < n (at most block_frames), with f = `cycles_per_frame`
/// and its table `t`: an exact angle at each multiple of table_frames, added to those of the table. With
/// wave::cosine: the same carrier a quarter of a cycle later.
void sine_block(const oscillator_table& t, double cycles_per_frame, std::int64_t first, unsigned n,
                double* out, wave w = wave::sine) noexcept;

/// Computes out[j] *= offset + scale * cos(2 pi (a + (offset + j - lo) f)) for the part's j: both halves of a
/// raised cosine. `base` is a's sine and cosine, `t` f's table.
void times_cosine(const oscillator_table& t, sine_cosine base, double offset, double scale,
                  const table_part& p, double* out) noexcept;

} // namespace tactor::synth
