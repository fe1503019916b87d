// SPDX-License-Identifier: MIT
#include "study/random/random.hpp"

#include <bit>
#include <cmath>

#include "core/sha256.hpp"

namespace tactor::study {

random_numbers::random_numbers(std::string_view seed) : s_{}
{
    const detail::sha256_digest d = detail::sha256(seed);
    for (std::size_t i = 0; i < d.size(); ++i)
        s_[i / 8] = s_[i / 8] << 8 | d[i];
}

std::uint64_t random_numbers::next() noexcept
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

std::uint32_t random_numbers::below(std::uint32_t n) noexcept
{
    const auto product = [&] { return (next() >> 32) * n; };
    std::uint64_t m = product();
    if (static_cast<std::uint32_t>(m) < n) {
        const std::uint32_t least = (0U - n) % n; // 2^32 mod n: below that some numbers come once too often
        while (static_cast<std::uint32_t>(m) < least)
            m = product();
    }
    return static_cast<std::uint32_t>(m >> 32);
}

double random_numbers::unit() noexcept
{
    return static_cast<double>(next() >> 11) * 0x1p-53;
}

double random_numbers::normal() noexcept
{
    for (;;) {
        const double x = 2.0 * unit() - 1.0;
        const double y = 2.0 * unit() - 1.0;
        const double s = x * x + y * y;
        if (s > 0.0 && s < 1.0)
            return x * std::sqrt(-2.0 * std::log(s) / s);
    }
}

} // namespace tactor::study
