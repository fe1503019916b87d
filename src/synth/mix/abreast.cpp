// SPDX-License-Identifier: MIT
#include "synth/mix/abreast.hpp"

#include <cstring>

namespace tactor::synth {

namespace {

using lanes = std::array<const lane*, abreast>;
using quad = std::uint32_t __attribute__((vector_size(16)));
using short_quad = std::uint16_t __attribute__((vector_size(8)));

/// A frame, each sample cut to the element of Row.
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

template <class Row>
void write(const lanes& from, unsigned n, std::byte* out, std::size_t stride) noexcept
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

} // namespace

void write_abreast(const std::array<const lane*, abreast>& from, std::size_t bytes, unsigned n,
                   std::byte* out, std::size_t stride) noexcept
{
    if (bytes == 2)
        write<short_quad>(from, n, out, stride);
    else
        write<quad>(from, n, out, stride);
}

} // namespace tactor::synth
