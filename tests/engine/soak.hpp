// SPDX-License-Identifier: MIT
// Soaks are shortened where each instruction costs tens of them, under sanitizers and emulation: the lanes
// set TACTOR_SOAK=short.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace tactor::test {

/// `whole`, or `shortened` where that was asked for, which it then says.
inline std::uint64_t soak_length(const char* what, std::uint64_t whole, std::uint64_t shortened)
{
    const char* asked = std::getenv("TACTOR_SOAK");
    if (asked == nullptr || std::string_view(asked) != "short")
        return whole;
    std::printf("\nSHORTENED: %s: %llu instead of %llu\n", what, static_cast<unsigned long long>(shortened),
                static_cast<unsigned long long>(whole));
    std::fflush(stdout);
    return shortened;
}

} // namespace tactor::test
