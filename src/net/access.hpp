// SPDX-License-Identifier: MIT
/// \file
/// Access rules: which machines may send datagrams to the server, and which browser requests are meant for
/// this server. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/address.hpp>

namespace tactor::net {

/// Returns the IPv4 address of an IPv4-mapped IPv6 address. Returns other addresses unchanged.
boost::asio::ip::address simplify_address(const boost::asio::ip::address& a);

/// Addresses that begin with the same bits.
struct address_prefix {
    boost::asio::ip::address address;
    unsigned bits = 0;
};

/// Reads "192.168.1.0/24", "fd00::/8", or an address alone. \pre options::read_serve() has accepted it.
address_prefix parse_prefix(const std::string& text);

/// Returns true for the loopback addresses of this machine, and for addresses with a prefix in `peers`. An
/// IPv4-mapped IPv6 address counts as IPv4.
bool is_accepted(const boost::asio::ip::address& from, const std::vector<address_prefix>& peers);

/// Returns true if a Host header names this server. It may contain localhost or the local address of the
/// connection, with the port of the connection, or an element of `allowed` ("pi.lan" or "pi.lan:4003"). This
/// protects against DNS rebinding: a foreign page whose name resolves to this machine sends another name.
/// `local` is "127.0.0.1:4003" or "[::1]:4003".
bool is_server_host(std::string_view host, std::string_view local, const std::vector<std::string>& allowed);

/// Returns true if an Origin header names this server. It may be http://HOST, or http or https with an
/// element of `allowed`.
bool is_server_origin(std::string_view origin, std::string_view host,
                      const std::vector<std::string>& allowed);

/// Host and path of a request.
struct web_target {
    std::string_view host;
    std::string_view path;
};

/// Returns host and path from a request's target and its Host header. The target may be a full URL
/// ("http://pi.lan/rpc", as in requests to a proxy), whose host then overrides the header. A target that is
/// neither a URL nor a path gives a path that does not exist.
web_target parse_target(std::string_view target, std::string_view host);

/// Returns the token after "Bearer " in an Authorization header, or "" if there is none.
std::string_view bearer_token(std::string_view authorization);

} // namespace tactor::net
