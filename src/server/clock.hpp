// SPDX-License-Identifier: MIT
/// \file
/// Times as messages have them: seconds, of CLOCK_MONOTONIC and of the day.
#pragma once

#include <chrono>
#include <cstdint>

namespace tactor::server {

inline double seconds(std::int64_t ns) noexcept
{
    return static_cast<double>(ns) * 1e-9;
}

/// Since 1970.
inline std::int64_t unix_ns() noexcept
{
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
}

} // namespace tactor::server
