// SPDX-License-Identifier: MIT
/// \file
/// Random numbers that are the same on every machine, for everything that is drawn in a study.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace tactor::study {

/// xoshiro256** of Blackman and Vigna (2018). Its state is the SHA-256 of a text, eight bytes a word, the
/// first the most significant.
class random_numbers {
public:
    explicit random_numbers(std::string_view seed);
    /// From a state, which must not be all zeros.
    explicit random_numbers(const std::array<std::uint64_t, 4>& state) noexcept : s_(state) {}

    std::uint64_t next() noexcept;
    /// 0 to n - 1, each as likely as the others (Lemire 2019, on the upper 32 bits). n must not be 0.
    std::uint32_t below(std::uint32_t n) noexcept;
    /// From 0 to below 1, a multiple of 2^-53.
    double unit() noexcept;
    /// Of mean 0 and standard deviation 1 (Marsaglia's polar method; its second number is not kept).
    double normal() noexcept;

private:
    std::array<std::uint64_t, 4> s_;
};

/// All orders are as likely as each other: Fisher-Yates, from the end.
template <typename T>
void shuffle(std::span<T> values, random_numbers& r)
{
    for (std::size_t i = values.size(); i > 1; --i)
        std::swap(values[i - 1], values[r.below(static_cast<std::uint32_t>(i))]);
}

} // namespace tactor::study
