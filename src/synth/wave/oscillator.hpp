// SPDX-License-Identifier: MIT
/// \file
/// Carriers. The angle is exact every 64 frames; the frames between come from a table by angle addition. No
/// error accumulates, however long the carrier runs.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tactor::synth {

/// Sine and cosine of an angle in cycles, with the same bits on every machine. The results of the C library
/// depend on its version and the processor.
struct sine_cosine {
    double sin = 0.0;
    double cos = 1.0;
};

/// 1.5 * 2^52: adding it to a number rounds off the fraction.
inline constexpr double rounds = 6755399441055744.0;

/// Rounds to the nearest integer, half to even, in plain arithmetic; |x| < 2^51.
inline double nearest(double x) noexcept
{
    return (x + rounds) - rounds;
}

/// Returns sin and cos of 2 pi x to about 1e-16, for |x| < 5e14: 40 years of the highest carrier. Uses the
/// Taylor series up to an eighth of a circle from the nearest quarter; the next terms are below 1e-18. Has no
/// branches, so that the compiler vectorises loops over it.
inline sine_cosine sincos_turns(double x) noexcept
{
    const double shifted = 4.0 * x + rounds;
    const double quarter = shifted - rounds;
    const double t = 6.283185307179586477 * (x - 0.25 * quarter);
    const double u = t * t;
    double s = 1.0 / 355687428096000.0;
    s = s * u - 1.0 / 1307674368000.0;
    s = s * u + 1.0 / 6227020800.0;
    s = s * u - 1.0 / 39916800.0;
    s = s * u + 1.0 / 362880.0;
    s = s * u - 1.0 / 5040.0;
    s = s * u + 1.0 / 120.0;
    s = s * u - 1.0 / 6.0;
    s = t + t * (u * s);
    double c = 1.0 / 20922789888000.0;
    c = c * u - 1.0 / 87178291200.0;
    c = c * u + 1.0 / 479001600.0;
    c = c * u - 1.0 / 3628800.0;
    c = c * u + 1.0 / 40320.0;
    c = c * u - 1.0 / 720.0;
    c = c * u + 1.0 / 24.0;
    c = 1.0 + u * (u * c - 0.5);
    // The low bits of the shifted number are those of the count of quarters.
    const auto quarters = std::bit_cast<std::uint64_t>(shifted);
    const bool odd = (quarters & 1) != 0;
    const auto negative = [](double v, std::uint64_t bit) {
        return std::bit_cast<double>(std::bit_cast<std::uint64_t>(v) ^ (bit << 63));
    };
    return {negative(odd ? c : s, quarters >> 1 & 1), negative(odd ? s : c, (quarters + 1) >> 1 & 1)};
}

/// Maximum number of frames that are mixed at once. Samples do not depend on the start of a block.
inline constexpr unsigned block_frames = 512;
/// Frames from one exact angle to the next.
inline constexpr unsigned table_frames = 64;

using block = std::array<double, block_frames>;

/// Components of a carrier. Together they give the envelope: sin^2 + cos^2 = 1 in each frame.
enum class wave : unsigned char { sine, cosine };

/// Sine and cosine of the first frames of one frequency.
struct oscillator_table {
    alignas(64) std::array<double, table_frames> sin;
    alignas(64) std::array<double, table_frames> cos;
};

/// Cache of the tables of up to 1024 frequencies. A hash of the frequency selects a few places. A new
/// frequency replaces a random one of them, not the oldest: if more frequencies take turns than there are
/// places, the oldest is needed next.
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
    std::size_t choose_table_place(const std::array<double, places>& keys) noexcept;

    std::array<std::array<double, places>, rows> keys_;
    std::uint32_t chance_ = 0;
    std::vector<oscillator_table> tables_;
};

/// Part of a block between two multiples of table_frames in a carrier's own frame count. `base` is the frame
/// of the lower multiple. Angle addition starts there, independent of blocks, so a stroke has the same
/// samples wherever it begins.
struct table_part {
    std::int64_t base = 0;
    unsigned lo = 0; ///< index in the block
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
/// and its table `t`. Adds the angles of the table to an exact angle at each multiple of
/// table_frames. With wave::cosine, computes the same carrier a quarter of a cycle later.
void fill_sine_block(const oscillator_table& t, double cycles_per_frame, std::int64_t first, unsigned n,
                     double* out, wave w = wave::sine) noexcept;

/// Computes out[j] *= offset + scale * cos(2 pi (a + (p.offset + j - p.lo) f)) for the frames j of the part,
/// for either half of a raised cosine. `base`: sine and cosine of a. `t`: table of f.
void apply_cosine_factor(const oscillator_table& t, sine_cosine base, double offset, double scale,
                         const table_part& p, double* out) noexcept;

} // namespace tactor::synth
