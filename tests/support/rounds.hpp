// SPDX-License-Identifier: MIT
/// \file
/// How long a test goes on.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace tactor::test {

/// Whether tests are to do less, as where each instruction costs tens of them, under sanitizers and
/// emulation: the lanes set TACTOR_SOAK=short.
inline bool shortened()
{
    const char* asked = std::getenv("TACTOR_SOAK");
    return asked != nullptr && std::string_view(asked) == "short";
}

/// `all`, and an eighth of it where tests are to do less: what is looked for there is in any of the rounds,
/// and the suite runs all.
inline int rounds(int all)
{
    return shortened() ? all / 8 : all;
}

/// The same, and `all` of them where everything is asked for, which takes minutes: TACTOR_SOAK=whole.
inline int rounds(int some, int all)
{
    const char* asked = std::getenv("TACTOR_SOAK");
    return asked != nullptr && std::string_view(asked) == "whole" ? all : rounds(some);
}

/// `whole`, or `short_one` where tests are to do less, which it then says.
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
