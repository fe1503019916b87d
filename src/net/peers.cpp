// SPDX-License-Identifier: MIT
#include "net/peers.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::net {
namespace {

namespace ip = boost::asio::ip;

ip::address plain(const ip::address& a)
{
    if (a.is_v6() && a.to_v6().is_v4_mapped())
        return ip::make_address_v4(ip::v4_mapped, a.to_v6());
    return a;
}

unsigned bits_of(const ip::address& a)
{
    return a.is_v4() ? 32 : 128;
}

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
    const auto slash = text.find('/');
    boost::system::error_code none;
    address_prefix p{ip::make_address(text.substr(0, slash), none), 0};
    bool good = !none;
    if (good)
        p.bits = bits_of(p.address);
    if (good && slash != std::string::npos) {
        const unsigned most = p.bits;
        const char* const end = text.data() + text.size();
        const auto r = std::from_chars(text.data() + slash + 1, end, p.bits);
        good = r.ec == std::errc() && r.ptr == end && p.bits <= most;
    }
    if (!good)
        throw error(error_kind::bad_input, what,
                    fmt::format("\"{}\" is neither an address nor a prefix", text),
                    "such as 192.168.1.7, 192.168.1.0/24 or fd00::/8");
    return p;
}

bool is_heard(const ip::address& from, const std::vector<address_prefix>& peers)
{
    const ip::address a = plain(from);
    return a.is_loopback() ||
           std::any_of(peers.begin(), peers.end(), [&](const address_prefix& p) { return within(a, p); });
}

} // namespace tactor::net
