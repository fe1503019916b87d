// SPDX-License-Identifier: MIT
#include "net/access.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/network_v4.hpp>
#include <boost/asio/ip/network_v6.hpp>

#include "core/split.hpp"
#include "core/words.hpp"

namespace tactor::net {
namespace {

namespace ip = boost::asio::ip;

bool is_in_prefix(const ip::address& a, const address_prefix& p)
{
    const auto bits = static_cast<unsigned short>(p.bits);
    if (a.is_v4() != p.address.is_v4())
        return false;
    if (a.is_v4())
        return ip::network_v4(a.to_v4(), bits).network() == ip::network_v4(p.address.to_v4(), bits).network();
    return ip::network_v6(a.to_v6(), bits).network().to_bytes() == // drops the scope id
           ip::network_v6(p.address.to_v6(), bits).network().to_bytes();
}

bool is_same_name(std::string_view a, std::string_view b)
{
    return to_lower_case(std::string(a)) == to_lower_case(std::string(b));
}

// Splits "[::1]:4003" into "::1" and "4003". The port is empty if there is none. Both are empty if the text
// is not valid.
std::pair<std::string_view, std::string_view> split(std::string_view host)
{
    const bool bracketed = host.starts_with('[');
    const std::size_t end = bracketed ? host.find(']') : std::min(host.find(':'), host.size());
    if (end == std::string_view::npos)
        return {};
    const std::string_view name = bracketed ? host.substr(1, end - 1) : host.substr(0, end);
    const std::string_view rest = host.substr(bracketed ? end + 1 : end);
    if (bracketed && name.find(':') == std::string_view::npos)
        return {}; // only IPv6 addresses may be in brackets
    if (rest.empty())
        return {name, {}};
    if (rest.front() != ':' || !detail::parse_number_text<std::uint16_t>(rest.substr(1)))
        return {};
    return {name, rest.substr(1)};
}

bool is_same_address(std::string_view a, std::string_view b)
{
    // make_address() stops at a zero byte and would accept any text after it.
    if (a.find('\0') != std::string_view::npos)
        return false;
    boost::system::error_code none;
    const auto x = boost::asio::ip::make_address(std::string(a), none);
    if (none)
        return false;
    const auto y = boost::asio::ip::make_address(std::string(b), none);
    return !none && simplify_address(x) == simplify_address(y);
}

// Default port of http, which browsers leave out.
constexpr std::string_view usual_port = "80";

bool is_host_allowed(std::string_view host, std::string_view port, const std::vector<std::string>& allowed)
{
    return std::any_of(allowed.begin(), allowed.end(), [&](const std::string& a) {
        const auto [name, its_port] = split(a);
        return !name.empty() && is_same_name(name, host) && (its_port.empty() || its_port == port);
    });
}

} // namespace

ip::address simplify_address(const ip::address& a)
{
    if (a.is_v6() && a.to_v6().is_v4_mapped())
        return ip::make_address_v4(ip::v4_mapped, a.to_v6());
    return a;
}

address_prefix parse_prefix(const std::string& text)
{
    const auto slash = text.find('/');
    const ip::address address = ip::make_address(text.substr(0, slash));
    const unsigned all = address.is_v4() ? 32 : 128;
    return {address,
            slash == text.npos ? all : detail::parse_number_text<unsigned>(text.substr(slash + 1)).value()};
}

bool is_accepted(const ip::address& from, const std::vector<address_prefix>& peers)
{
    const ip::address a = simplify_address(from);
    return a.is_loopback() || std::any_of(peers.begin(), peers.end(),
                                          [&](const address_prefix& p) { return is_in_prefix(a, p); });
}

bool is_server_host(std::string_view host, std::string_view local, const std::vector<std::string>& allowed)
{
    const auto [name, own_port] = split(host);
    const std::string_view port = own_port.empty() ? usual_port : own_port;
    const auto [address, local_port] = split(local);
    if (name.empty())
        return false;
    if (port == local_port && (is_same_name(name, "localhost") || is_same_address(name, address)))
        return true;
    return is_host_allowed(name, port, allowed);
}

bool is_server_origin(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed)
{
    constexpr std::string_view http = "http://";
    constexpr std::string_view https = "https://";
    if (origin.starts_with(http) && is_same_name(origin.substr(http.size()), host))
        return true;
    const bool secure = origin.starts_with(https);
    if (!secure && !origin.starts_with(http))
        return false;
    const auto [name, port] = split(origin.substr(secure ? https.size() : http.size()));
    return is_host_allowed(name, port.empty() ? (secure ? "443" : usual_port) : port, allowed);
}

web_target parse_target(std::string_view target, std::string_view host)
{
    constexpr std::string_view http = "http://";
    const auto without_query = [](std::string_view t) { return t.substr(0, t.find('?')); };
    if (!is_same_name(target.substr(0, http.size()), http))
        return {host, without_query(target)};
    target.remove_prefix(http.size());
    const std::size_t end = std::min(target.find_first_of("/?"), target.size());
    const std::string_view path = without_query(target.substr(end));
    return {target.substr(0, end), path.empty() ? "/" : path};
}

std::string_view bearer_token(std::string_view authorization)
{
    constexpr std::string_view scheme = "Bearer ";
    if (authorization.size() <= scheme.size() ||
        !is_same_name(authorization.substr(0, scheme.size()), scheme))
        return {};
    return authorization.substr(scheme.size());
}

} // namespace tactor::net
