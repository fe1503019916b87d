// SPDX-License-Identifier: MIT
// Prefixes of network addresses as files write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <arpa/inet.h>
#include <netinet/in.h>

#include "core/split.hpp"

namespace tactor::detail {

/// Returns the number of bits that count in "192.168.1.0/24", "fd00::/8", or an address alone, such as
/// fe80::1%eth0. Returns nothing for other texts.
inline std::optional<unsigned> prefix_bits(std::string_view text)
{
    const auto slash = text.find('/');
    const std::string address(text.substr(0, slash));
    in6_addr bytes{}; // large enough for either family
    const bool v4 = ::inet_pton(AF_INET, address.c_str(), &bytes) == 1;
    if (!v4 && ::inet_pton(AF_INET6, address.substr(0, address.find('%')).c_str(), &bytes) != 1)
        return {};
    const unsigned most = v4 ? 32 : 128;
    if (slash == std::string_view::npos)
        return most;
    text.remove_prefix(slash + 1);
    const auto bits = number_in<unsigned>(text);
    return bits && *bits <= most ? bits : std::nullopt;
}

} // namespace tactor::detail
