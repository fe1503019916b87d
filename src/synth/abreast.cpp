// SPDX-License-Identifier: MIT
#include "synth/abreast.hpp"

#include <cstring>

#include "synth/clones.hpp"

#ifdef TACTOR_HAS_CLONES
#include <immintrin.h>
#endif

namespace tactor::synth {

namespace {

using lanes = std::array<const lane*, abreast>;
using quad = std::uint32_t __attribute__((vector_size(16)));
using short_quad = std::uint16_t __attribute__((vector_size(8)));

/// A frame, each sample cut to the element of Row.
template <class Row, class Vector>
void store(const Vector& frame, std::byte* out) noexcept
{
    quad q;
    static_assert(sizeof q == sizeof frame);
    std::memcpy(&q, &frame, sizeof q);
    const Row cut = __builtin_convertvector(q, Row);
    std::memcpy(out, &cut, sizeof cut);
}

#ifdef TACTOR_HAS_CLONES

const bool has_avx2 = [] {
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2") != 0;
}();

/// Eight frames at a time, for as long as there are: returns those done. Halves of a register do not mix, so
/// the upper ones hold frames 4 to 7.
template <class Row>
__attribute__((target("avx2"))) unsigned eights(const lanes& from, unsigned n, std::byte* out,
                                                std::size_t stride) noexcept
{
    unsigned i = 0;
    for (; i + 8 <= n; i += 8, out += 8 * stride) {
        const __m256i a = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from[0]->data() + i));
        const __m256i b = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from[1]->data() + i));
        const __m256i c = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from[2]->data() + i));
        const __m256i d = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from[3]->data() + i));
        const __m256i ab = _mm256_unpacklo_epi32(a, b);
        const __m256i cd = _mm256_unpacklo_epi32(c, d);
        const __m256i ab_next = _mm256_unpackhi_epi32(a, b);
        const __m256i cd_next = _mm256_unpackhi_epi32(c, d);
        const __m256i row0 = _mm256_unpacklo_epi64(ab, cd);
        const __m256i row1 = _mm256_unpackhi_epi64(ab, cd);
        const __m256i row2 = _mm256_unpacklo_epi64(ab_next, cd_next);
        const __m256i row3 = _mm256_unpackhi_epi64(ab_next, cd_next);
        store<Row>(_mm256_castsi256_si128(row0), out);
        store<Row>(_mm256_castsi256_si128(row1), out + stride);
        store<Row>(_mm256_castsi256_si128(row2), out + 2 * stride);
        store<Row>(_mm256_castsi256_si128(row3), out + 3 * stride);
        store<Row>(_mm256_extracti128_si256(row0, 1), out + 4 * stride);
        store<Row>(_mm256_extracti128_si256(row1, 1), out + 5 * stride);
        store<Row>(_mm256_extracti128_si256(row2, 1), out + 6 * stride);
        store<Row>(_mm256_extracti128_si256(row3, 1), out + 7 * stride);
    }
    return i;
}

#else

constexpr bool has_avx2 = false;

template <class Row>
unsigned eights(const lanes&, unsigned, std::byte*, std::size_t) noexcept
{
    return 0;
}

#endif

quad load(const lane& v, unsigned i) noexcept
{
    quad q;
    std::memcpy(&q, &v[i], sizeof q);
    return q;
}

template <class Row>
void write(const lanes& from, unsigned n, std::byte* out, std::size_t stride) noexcept
{
    unsigned i = has_avx2 ? eights<Row>(from, n, out, stride) : 0;
    out += i * stride;
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
    for (; i < n; ++i, out += stride) {
        store<Row>(quad{(*from[0])[i], (*from[1])[i], (*from[2])[i], (*from[3])[i]}, out);
    }
}

} // namespace

void write_abreast(const std::array<const lane*, abreast>& from, std::size_t bytes, unsigned n,
                   std::byte* out, std::size_t stride) noexcept
{
    if (bytes == 2) {
        write<short_quad>(from, n, out, stride);
    } else {
        write<quad>(from, n, out, stride);
    }
}

} // namespace tactor::synth
