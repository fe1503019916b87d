// SPDX-License-Identifier: MIT
/// \file
/// The clock of the holder and its player. Async-signal-safe.
#pragma once

#include <cstdint>
#include <ctime>

namespace tactor::gpio {

inline std::int64_t now_ms() noexcept
{
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1000 + t.tv_nsec / 1'000'000;
}

} // namespace tactor::gpio
