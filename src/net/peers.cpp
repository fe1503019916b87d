// SPDX-License-Identifier: MIT
#include "net/peers.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/prefix_bits.hpp"

namespace tactor::net {

namespace ip = boost::asio::ip;

ip::address plain(const ip::address& a)
{
    if (a.is_v6() && a.to_v6().is_v4_mapped())
        return ip::make_address_v4(ip::v4_mapped, a.to_v6());
    return a;
}

namespace {

template <typename Bytes>
bool same_beginning(const Bytes& a, const Bytes& b, unsigned bits)
{
    const auto whole = static_cast<std::ptrdiff_t>(bits / 8);
    if (!std::equal(a.begin(), a.begin() + whole, b.begin()))
        return false;
    const unsigned left = bits % 8;
    const auto i = static_cast<std::size_t>(whole);
    return left == 0 || (a[i] ^ b[i]) >> (8U - left) == 0;
}

bool within(const ip::address& a, const address_prefix& p)
{
    if (a.is_v4() != p.address.is_v4())
        return false;
    return a.is_v4() ? same_beginning(a.to_v4().to_bytes(), p.address.to_v4().to_bytes(), p.bits)
                     : same_beginning(a.to_v6().to_bytes(), p.address.to_v6().to_bytes(), p.bits);
}

} // namespace

address_prefix parse_prefix(const std::string& text, const std::string& what)
{
    const auto bits = detail::prefix_bits(text);
    boost::system::error_code failed;
    const ip::address address = ip::make_address(text.substr(0, text.find('/')), failed);
    if (!bits || failed)
        throw error(error_kind::bad_input, what,
                    fmt::format("\"{}\" is neither an address nor a prefix", text),
                    "such as 192.168.1.7, 192.168.1.0/24 or fd00::/8");
    return {address, *bits};
}

bool is_heard(const ip::address& from, const std::vector<address_prefix>& peers)
{
    const ip::address a = plain(from);
    return a.is_loopback() ||
           std::any_of(peers.begin(), peers.end(), [&](const address_prefix& p) { return within(a, p); });
}

} // namespace tactor::net
