// SPDX-License-Identifier: MIT
#include "synth/tone/waves.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

#include "synth/mix/sincos.hpp"

namespace tactor::synth {

namespace {

using complex = std::complex<double>;

complex unit(double turns)
{
    const sine_cosine v = sincos_turns(turns);
    return {v.cos, v.sin};
}

// Multiplies. The library's multiplication checks for infinities.
complex times(complex a, complex b)
{
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

void reverse_bits(spectrum& x)
{
    const std::size_t n = x.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
        std::size_t bit = n >> 1U;
        for (; (j & bit) != 0; bit >>= 1U)
            j ^= bit;
        j ^= bit;
        if (i < j)
            std::swap(x[i], x[j]);
    }
}

/// Returns exp(sign pi i n^2 / m), with n^2 reduced as an integer.
complex chirp(std::uint64_t n, std::uint64_t m, double sign)
{
    return unit(sign * static_cast<double>(n * n % (2 * m)) / static_cast<double>(2 * m));
}

} // namespace

void fourier_sum(spectrum& x)
{
    reverse_bits(x);
    const std::size_t n = x.size();
    spectrum turn(std::max<std::size_t>(n / 2, 1));
    for (std::size_t k = 0; k < turn.size(); ++k)
        turn[k] = unit(static_cast<double>(k) / static_cast<double>(n));
    for (std::size_t half = 1; half < n; half *= 2) {
        const std::size_t step = n / (2 * half);
        for (std::size_t from = 0; from < n; from += 2 * half) {
            for (std::size_t k = 0; k < half; ++k) {
                const complex odd = times(turn[k * step], x[from + half + k]);
                x[from + half + k] = x[from + k] - odd;
                x[from + k] += odd;
            }
        }
    }
}

// Computes a sum of any length as a convolution, whose length may be a power of 2 (Bluestein 1970).
spectrum fourier_coefficients(std::span<const float> x, std::size_t count)
{
    const std::size_t m = x.size();
    const std::size_t n = std::bit_ceil(2 * m);
    spectrum a(n);
    spectrum b(n);
    for (std::size_t i = 0; i < m; ++i) {
        a[i] = static_cast<double>(x[i]) * chirp(i, m, -1.0);
        b[i] = chirp(i, m, 1.0);
        b[(n - i) % n] = b[i];
    }
    fourier_sum(a);
    fourier_sum(b);
    for (std::size_t i = 0; i < n; ++i)
        a[i] = times(a[i], b[i]);
    // The same sum gives the convolution backwards.
    fourier_sum(a);
    spectrum c(count);
    const double scale = 1.0 / (static_cast<double>(n) * static_cast<double>(m));
    for (std::size_t k = 0; k < count; ++k)
        c[k] = scale * times(a[(n - k) % n], chirp(k, m, -1.0));
    return c;
}

} // namespace tactor::synth
