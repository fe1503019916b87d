// SPDX-License-Identifier: MIT
/// \file
/// Length of a test.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace tactor::test {

/// Returns true where tests do less, as where each instruction costs tens of them, under sanitizers and
/// emulation: the lanes set TACTOR_SOAK=short.
inline bool shortened()
{
    const char* asked = std::getenv("TACTOR_SOAK");
    return asked != nullptr && std::string_view(asked) == "short";
}

/// Returns true where tests do all that they can, which takes minutes: TACTOR_SOAK=whole.
inline bool whole()
{
    const char* asked = std::getenv("TACTOR_SOAK");
    return asked != nullptr && std::string_view(asked) == "whole";
}

/// Returns `all`, or an eighth and at least 1 where tests do less: any of the rounds can find a fault, and
/// the suite runs all.
inline int rounds(int all)
{
    return shortened() ? std::max(1, all / 8) : all;
}

/// Returns the same, but all rounds with TACTOR_SOAK=whole.
inline int rounds(int some, int all)
{
    return whole() ? all : rounds(some);
}

/// Returns `whole`, or `short_one` where tests do less, and prints that.
inline std::uint64_t soak_length(const char* what, std::uint64_t whole, std::uint64_t short_one)
{
    if (!shortened())
        return whole;
    std::printf("\nSHORTENED: %s: %llu instead of %llu\n", what, static_cast<unsigned long long>(short_one),
                static_cast<unsigned long long>(whole));
    std::fflush(stdout);
    return short_one;
}

} // namespace tactor::test
