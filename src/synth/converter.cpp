// SPDX-License-Identifier: MIT
#include "synth/converter.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "synth/clones.hpp"
#include "synth/oscillator.hpp"
#include "synth/sincos.hpp"

namespace tactor::synth {

namespace {

static_assert(std::endian::native == std::endian::little, "the formats are little-endian");

/// Bytes of each of n values to places `stride` apart; the first `Bytes` bytes are the low ones.
template <std::size_t Bytes, class T>
void scatter(const T* v, unsigned n, std::byte* out, std::size_t stride) noexcept
{
    for (unsigned i = 0; i < n; ++i) {
        std::memcpy(out + i * stride, v + i, Bytes);
    }
}

TACTOR_CLONES void to_float(const double* __restrict x, unsigned n, float* __restrict v) noexcept
{
    for (unsigned i = 0; i < n; ++i) {
        v[i] = static_cast<float>(x[i] + 0.0); // -0 + 0 = +0
    }
}

TACTOR_CLONES void to_integer(const double* __restrict x, unsigned n, double scale,
                              std::int32_t* __restrict v) noexcept
{
    for (unsigned i = 0; i < n; ++i) {
        const double r = nearest(x[i] * scale);
        const double low = r < scale - 1.0 ? r : scale - 1.0;
        v[i] = static_cast<std::int32_t>(low > -scale ? low : -scale);
    }
}

template <std::size_t Bytes>
void integers(const double* x, unsigned n, double scale, std::byte* out, std::size_t stride) noexcept
{
    std::array<std::int32_t, block_frames> v;
    to_integer(x, n, scale, v.data());
    scatter<Bytes>(v.data(), n, out, stride);
}

} // namespace

void convert(sample_format f, const double* x, unsigned n, std::byte* out, std::size_t stride) noexcept
{
    switch (f) {
    case sample_format::float32: {
        std::array<float, block_frames> v;
        to_float(x, n, v.data());
        scatter<sizeof(float)>(v.data(), n, out, stride);
        break;
    }
    case sample_format::s16:
        integers<2>(x, n, 32768.0, out, stride);
        break;
    case sample_format::s24_3:
        integers<3>(x, n, 8388608.0, out, stride);
        break;
    case sample_format::s24:
        integers<4>(x, n, 8388608.0, out, stride);
        break;
    case sample_format::s32:
        integers<4>(x, n, 2147483648.0, out, stride);
        break;
    }
}

} // namespace tactor::synth
