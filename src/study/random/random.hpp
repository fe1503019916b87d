// SPDX-License-Identifier: MIT
/// \file
/// Random numbers for all draws of a study. They are the same on every machine.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "core/sha256.hpp"

namespace tactor::study {

/// The generator xoshiro256** (Blackman and Vigna 2018). The initial state is the SHA-256 of a text. Each
/// word of the state is eight bytes of the SHA-256, with the most significant byte first.
class random_numbers {
public:
    explicit random_numbers(std::string_view seed) : s_{}
    {
        const detail::sha256_digest d = detail::sha256(seed);
        for (std::size_t i = 0; i < d.size(); ++i)
            s_[i / 8] = s_[i / 8] << 8 | d[i];
    }
    /// Starts with this state, which must not be all zeros.
    explicit random_numbers(const std::array<std::uint64_t, 4>& state) noexcept : s_(state) {}

    std::uint64_t next() noexcept
    {
        const std::uint64_t drawn = std::rotl(s_[1] * 5, 7) * 9;
        const std::uint64_t t = s_[1] << 17;
        s_[2] ^= s_[0];
        s_[3] ^= s_[1];
        s_[1] ^= s_[2];
        s_[0] ^= s_[3];
        s_[2] ^= t;
        s_[3] = std::rotl(s_[3], 45);
        return drawn;
    }

    /// Returns a uniformly distributed number from 0 to n - 1 (Lemire 2019, with the upper 32 bits). n must
    /// not be 0.
    std::uint32_t below(std::uint32_t n) noexcept
    {
        const auto product = [&] { return (next() >> 32) * n; };
        std::uint64_t m = product();
        if (static_cast<std::uint32_t>(m) < n) {
            const std::uint32_t least =
                (0U - n) % n; // 2^32 mod n: smaller remainders would make some numbers more likely
            while (static_cast<std::uint32_t>(m) < least)
                m = product();
        }
        return static_cast<std::uint32_t>(m >> 32);
    }

    /// Returns a uniformly distributed multiple of 2^-53, at least 0 and below 1.
    double unit() noexcept { return static_cast<double>(next() >> 11) * 0x1p-53; }

    /// Returns a normally distributed number with mean 0 and standard deviation 1, by Marsaglia's polar
    /// method. Does not use the second number of each pair.
    double normal() noexcept
    {
        for (;;) {
            const double x = 2.0 * unit() - 1.0;
            const double y = 2.0 * unit() - 1.0;
            const double s = x * x + y * y;
            if (s > 0.0 && s < 1.0)
                return x * std::sqrt(-2.0 * std::log(s) / s);
        }
    }

private:
    std::array<std::uint64_t, 4> s_;
};

/// Shuffles values by the Fisher-Yates algorithm, from the end. All orders are equally likely.
template <typename T>
void shuffle(std::span<T> values, random_numbers& r)
{
    for (std::size_t i = values.size(); i > 1; --i)
        std::swap(values[i - 1], values[r.below(static_cast<std::uint32_t>(i))]);
}

} // namespace tactor::study
