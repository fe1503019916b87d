// SPDX-License-Identifier: MIT
/// \file
/// Access rules: peers whose datagrams the server accepts, and browser requests that are meant for this
/// server. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/address.hpp>

namespace tactor::net {

/// Returns the IPv4 address that an IPv6 address contains; other addresses unchanged.
boost::asio::ip::address plain(const boost::asio::ip::address& a);

/// Addresses that begin with the same bits.
struct address_prefix {
    boost::asio::ip::address address;
    unsigned bits = 0;
};

/// Reads "192.168.1.0/24", "fd00::/8", or an address alone. \pre options::read_serve() has accepted it.
address_prefix parse_prefix(const std::string& text);

/// Returns true for this machine's own loopback addresses, and those of `peers`. An IPv4 address within IPv6
/// counts as IPv4.
bool is_accepted(const boost::asio::ip::address& from, const std::vector<address_prefix>& peers);

/// Returns true if a Host header means this server: localhost or the very address of the connection, each
/// with its port, or one of `allowed` ("pi.lan" or "pi.lan:4003"). A foreign page whose name was made to
/// point here has another name. `local`: "127.0.0.1:4003" or "[::1]:4003".
bool host_is_ours(std::string_view host, std::string_view local, const std::vector<std::string>& allowed);

/// Returns true if an Origin header means this server: http://HOST, or http or https with one of `allowed`.
bool origin_is_ours(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed);

/// Host and path of a request.
struct web_target {
    std::string_view host;
    std::string_view path;
};

/// Reads a request's target and its Host header. The target may be a whole address ("http://pi.lan/rpc", as
/// to a proxy), which overrides the header. A text that is neither an address nor a path becomes a path that
/// does not exist.
web_target parse_target(std::string_view target, std::string_view host);

/// Returns the token after "Bearer " in an Authorization header; empty for others.
std::string_view bearer_token(std::string_view authorization);

} // namespace tactor::net
