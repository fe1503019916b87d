// SPDX-License-Identifier: MIT
#include "synth/mix/converter.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "core/clones.hpp"
#include "synth/wave/oscillator.hpp"

namespace tactor::synth {
namespace {

/// Samples of one channel, as bit patterns.
struct alignas(64) lane : std::array<std::uint32_t, block_frames> {};

/// Number of channels that are written together.
constexpr std::size_t abreast = 4;

using lane_pointers = std::array<const lane*, abreast>;
using quad = std::uint32_t __attribute__((vector_size(16)));
using short_quad = std::uint16_t __attribute__((vector_size(8)));

/// Stores a frame. Truncates each sample to the element type of Row.
template <class Row>
void store(quad frame, std::byte* out) noexcept
{
    const Row cut = __builtin_convertvector(frame, Row);
    std::memcpy(out, &cut, sizeof cut);
}

quad load(const lane& v, unsigned i) noexcept
{
    quad q;
    std::memcpy(&q, &v[i], sizeof q);
    return q;
}

/// Writes n frames, `stride` bytes apart. A frame has one sample of each lane.
template <class Row>
void write(const lane_pointers& from, unsigned n, std::byte* out, std::size_t stride) noexcept
{
    unsigned i = 0;
    for (; i + 4 <= n; i += 4, out += 4 * stride) {
        const quad a = load(*from[0], i);
        const quad b = load(*from[1], i);
        const quad c = load(*from[2], i);
        const quad d = load(*from[3], i);
        const quad ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
        const quad cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
        const quad ab_next = __builtin_shufflevector(a, b, 2, 6, 3, 7);
        const quad cd_next = __builtin_shufflevector(c, d, 2, 6, 3, 7);
        store<Row>(__builtin_shufflevector(ab, cd, 0, 1, 4, 5), out);
        store<Row>(__builtin_shufflevector(ab, cd, 2, 3, 6, 7), out + stride);
        store<Row>(__builtin_shufflevector(ab_next, cd_next, 0, 1, 4, 5), out + 2 * stride);
        store<Row>(__builtin_shufflevector(ab_next, cd_next, 2, 3, 6, 7), out + 3 * stride);
    }
    for (; i < n; ++i, out += stride)
        store<Row>(quad{(*from[0])[i], (*from[1])[i], (*from[2])[i], (*from[3])[i]}, out);
}

static_assert(std::endian::native == std::endian::little, "the formats are little-endian");

// A value that is not a number becomes silence: no check before this one may let it become full scale.
TACTOR_CLONES void convert_to_float(const channel_samples& c, unsigned n,
                                    std::uint32_t* __restrict v) noexcept
{
    const double* __restrict x = c.x;
    const double gain = c.gain;
    for (unsigned i = 0; i < n; ++i) {
        const double y = gain * x[i] + 0.0; // -0 + 0 = +0
        v[i] = std::bit_cast<std::uint32_t>(static_cast<float>(y == y ? y : 0.0));
    }
}

TACTOR_CLONES void convert_to_integer(const channel_samples& c, unsigned n, double scale,
                                      std::uint32_t* __restrict v) noexcept
{
    const double* __restrict x = c.x;
    const double gain = c.gain;
    for (unsigned i = 0; i < n; ++i) {
        const double y = gain * x[i] * scale;
        const double r = nearest(y == y ? y : 0.0);
        const double low = r < scale - 1.0 ? r : scale - 1.0;
        v[i] = static_cast<std::uint32_t>(static_cast<std::int32_t>(low > -scale ? low : -scale));
    }
}

void convert_samples(format_kind f, const channel_samples& c, unsigned n, lane& v) noexcept
{
    switch (f) {
    case format_kind::float32:
        return convert_to_float(c, n, v.data());
    case format_kind::s16:
        return convert_to_integer(c, n, 32768.0, v.data());
    case format_kind::s24_3:
    case format_kind::s24_4:
        return convert_to_integer(c, n, 8388608.0, v.data());
    case format_kind::s32:
        return convert_to_integer(c, n, 2147483648.0, v.data());
    }
}

/// Writes the low `Bytes` bytes of each of n values, `stride` bytes apart.
template <std::size_t Bytes>
void scatter(const lane& v, unsigned n, std::byte* out, std::size_t stride) noexcept
{
    for (unsigned i = 0; i < n; ++i)
        std::memcpy(out + i * stride, &v[i], Bytes);
}

void scatter(const lane& v, std::size_t bytes, unsigned n, std::byte* out, std::size_t stride) noexcept
{
    switch (bytes) {
    case 2:
        return scatter<2>(v, n, out, stride);
    case 3:
        return scatter<3>(v, n, out, stride);
    default:
        return scatter<4>(v, n, out, stride);
    }
}

constexpr lane silent{};

} // namespace

void interleave(format_kind f, std::span<const channel_samples> sounding, std::size_t channels, unsigned n,
                std::byte* out) noexcept
{
    const std::size_t sample = sample_bytes(f);
    const std::size_t stride = channels * sample;
    if (sounding.size() < channels)
        std::memset(out, 0, n * stride);
    std::array<lane, abreast> lanes;
    std::size_t written = 0; // channels below this one are done
    while (!sounding.empty()) {
        // The tactors of a face are often on neighbouring channels: one store writes their samples.
        const std::size_t next = sounding[0].channel;
        const std::size_t first = std::min(next, channels - std::min(channels, abreast));
        const auto end = std::find_if(sounding.begin(), sounding.end(), [first](const channel_samples& c) {
            return c.channel >= first + abreast;
        });
        const auto count = static_cast<std::size_t>(end - sounding.begin());
        if (sample == 3 || channels < abreast || count < 2 || first < written) {
            convert_samples(f, sounding[0], n, lanes[0]);
            scatter(lanes[0], sample, n, out + next * sample, stride);
            sounding = sounding.subspan(1);
            written = next + 1;
            continue;
        }
        lane_pointers from{&silent, &silent, &silent, &silent};
        for (const channel_samples& c : sounding.first(count)) {
            const std::size_t i = c.channel - first;
            convert_samples(f, c, n, lanes[i]);
            from[i] = &lanes[i];
        }
        if (sample == 2)
            write<short_quad>(from, n, out + first * sample, stride);
        else
            write<quad>(from, n, out + first * sample, stride);
        sounding = sounding.subspan(count);
        written = first + abreast;
    }
}

const char* vector_loop_version() noexcept
{
#ifdef TACTOR_HAS_CLONES
    if (__builtin_cpu_supports("x86-64-v4"))
        return "avx-512";
    if (__builtin_cpu_supports("avx2"))
        return "avx2";
#endif
    return "baseline";
}

} // namespace tactor::synth
