// SPDX-License-Identifier: MIT
/// \file
/// Support for tests of the player.
#pragma once

#include <cstddef>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>

namespace tactor::test {

inline alsa_options nine(format_kind f = format_kind::s32)
{
    alsa_options o;
    o.channels = 9;
    o.format = f;
    return o;
}

/// Returns n bytes from `from` on.
inline std::vector<std::byte> part(const std::vector<std::byte>& all, std::size_t from, std::size_t n)
{
    REQUIRE(from + n <= all.size());
    return {all.begin() + static_cast<std::ptrdiff_t>(from),
            all.begin() + static_cast<std::ptrdiff_t>(from + n)};
}

} // namespace tactor::test
