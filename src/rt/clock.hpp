// SPDX-License-Identifier: MIT
/// \file
/// Clocks: CLOCK_MONOTONIC for everything that plays, CLOCK_BOOTTIME, which continues while the system
/// sleeps, and the time of day. Async-signal-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>

namespace tactor::rt {

inline constexpr std::int64_t ns_per_s = 1'000'000'000;

inline std::int64_t to_ns(const timespec& t) noexcept
{
    return std::int64_t{t.tv_sec} * ns_per_s + t.tv_nsec;
}

inline std::int64_t monotonic_ns() noexcept
{
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return to_ns(t);
}

/// Converts a CLOCK_MONOTONIC time to the steady clock of std::chrono, which is the same clock.
constexpr std::chrono::steady_clock::time_point to_time(std::int64_t monotonic_ns) noexcept
{
    return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(monotonic_ns));
}
constexpr std::int64_t to_ns(std::chrono::steady_clock::time_point t) noexcept
{
    return std::chrono::nanoseconds(t.time_since_epoch()).count();
}

inline std::int64_t boottime_ns() noexcept
{
    timespec t{};
    ::clock_gettime(CLOCK_BOOTTIME, &t);
    return to_ns(t);
}

/// Returns the time of day (CLOCK_REALTIME), ns since 1970.
inline std::int64_t unix_ns() noexcept
{
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    return to_ns(t);
}

inline std::int64_t monotonic_ms() noexcept
{
    return monotonic_ns() / 1'000'000;
}

inline timespec to_timespec(std::int64_t ns) noexcept
{
    return {.tv_sec = static_cast<time_t>(ns / ns_per_s), .tv_nsec = static_cast<long>(ns % ns_per_s)};
}

} // namespace tactor::rt
