// SPDX-License-Identifier: MIT
#include "synth/wave/oscillator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/clones.hpp"

namespace tactor::synth {

namespace {

/// Distributes the bits of a frequency over `rows`: Knuth's multiplicative hash.
std::size_t hash_row(double cycles_per_frame, std::size_t rows) noexcept
{
    return static_cast<std::size_t>((std::bit_cast<std::uint64_t>(cycles_per_frame) * 0x9E3779B97F4A7C15U) >>
                                    40) %
           rows;
}

/// Fills the table of a frequency.
void fill(oscillator_table& t, double cycles_per_frame) noexcept
{
    double* __restrict sin = t.sin.data();
    double* __restrict cos = t.cos.data();
    for (int j = 0; j < static_cast<int>(table_frames); ++j) {
        const sine_cosine v = sincos_turns(cycles_per_frame * j);
        sin[j] = v.sin;
        cos[j] = v.cos;
    }
}

/// Sines and cosines at the multiples of table_frames in a block, in whole vectors.
struct base_angles {
    static constexpr std::size_t vector = 8;
    static constexpr std::size_t most = (block_frames / table_frames + vector) / vector * vector;
    alignas(64) std::array<double, most> sin;
    alignas(64) std::array<double, most> cos;
};
static_assert(base_angles::most >= block_frames / table_frames + 1);

[[gnu::always_inline]] inline base_angles compute_base_angles(std::int64_t first, unsigned frames,
                                                              double cycles_per_frame) noexcept
{
    base_angles a;
    const auto at = static_cast<double>(first);
    const std::size_t count = (frames + table_frames - 1) / table_frames;
    for (std::size_t i = 0; i < count; i += base_angles::vector) {
        for (std::size_t j = i; j < i + base_angles::vector; ++j) {
            const sine_cosine v =
                sincos_turns((at + static_cast<double>(j * table_frames)) * cycles_per_frame);
            a.sin[j] = v.sin;
            a.cos[j] = v.cos;
        }
    }
    return a;
}

} // namespace

oscillator_tables::oscillator_tables() : tables_(rows * places)
{
    for (auto& keys : keys_)
        keys.fill(std::numeric_limits<double>::quiet_NaN());
}

std::size_t oscillator_tables::choose_table_place(const std::array<double, places>& keys) noexcept
{
    for (std::size_t i = 0; i < places; ++i)
        if (std::isnan(keys[i]))
            return i;
    chance_ = chance_ * 1664525U + 1013904223U;
    return chance_ >> (32U - place_bits);
}

const oscillator_table& oscillator_tables::get(double cycles_per_frame) noexcept
{
    const std::size_t number = hash_row(cycles_per_frame, rows);
    auto& keys = keys_[number];
    for (std::size_t i = 0; i < places; ++i)
        if (keys[i] == cycles_per_frame)
            return tables_[number * places + i];
    const std::size_t i = choose_table_place(keys);
    keys[i] = cycles_per_frame;
    oscillator_table& t = tables_[number * places + i];
    fill(t, cycles_per_frame);
    return t;
}

TACTOR_CLONES void fill_sine_block(const oscillator_table& t, double cycles_per_frame, std::int64_t first,
                                   unsigned n, double* out, wave w) noexcept
{
    auto offset = static_cast<unsigned>(static_cast<std::uint64_t>(first) % table_frames);
    const base_angles base = compute_base_angles(first - offset, offset + n, cycles_per_frame);
    for (std::size_t i = 0; n > 0; ++i) {
        const double* __restrict s = t.sin.data() + offset;
        const double* __restrict c = t.cos.data() + offset;
        double* __restrict o = out;
        const unsigned length = std::min(n, table_frames - offset);
        const double base_sin = w == wave::sine ? base.sin[i] : base.cos[i];
        const double base_cos = w == wave::sine ? base.cos[i] : -base.sin[i];
        for (unsigned j = 0; j < length; ++j)
            o[j] = base_sin * c[j] + base_cos * s[j];
        out += length;
        n -= length;
        offset = 0;
    }
}

TACTOR_CLONES void apply_cosine_factor(const oscillator_table& t, sine_cosine base, double offset,
                                       double scale, const table_part& p, double* out) noexcept
{
    const double* __restrict s = t.sin.data() + p.offset;
    const double* __restrict c = t.cos.data() + p.offset;
    double* __restrict o = out + p.lo;
    const unsigned n = p.hi - p.lo;
    for (unsigned j = 0; j < n; ++j)
        o[j] *= offset + scale * (base.cos * c[j] - base.sin * s[j]);
}

} // namespace tactor::synth
