// SPDX-License-Identifier: MIT
/// \file
/// Who may ask: whose datagrams are heard, and which requests of a browser are meant for this server. Pure
/// functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/address.hpp>

namespace tactor::net {

/// Returns an IPv4 address within IPv6 as what it is; any other as it is.
boost::asio::ip::address plain(const boost::asio::ip::address& a);

/// The addresses that begin with the same bits.
struct address_prefix {
    boost::asio::ip::address address;
    unsigned bits = 0;
};

/// Reads "192.168.1.0/24", "fd00::/8", or an address alone. \throws error (bad_input) that names `what`.
address_prefix parse_prefix(const std::string& text, const std::string& what);

/// Returns true for this machine's own loopback addresses, and those of `peers`. An IPv4 address within IPv6
/// counts as IPv4.
bool is_heard(const boost::asio::ip::address& from, const std::vector<address_prefix>& peers);

/// Returns true if a Host header is ours: localhost or the very address that the connection came to, each
/// with its port (a page whose name was made to point here has another name), or one of `allowed` ("pi.lan"
/// or "pi.lan:4003"). `local`: "127.0.0.1:4003" or "[::1]:4003".
bool host_is_ours(std::string_view host, std::string_view local, const std::vector<std::string>& allowed);

/// Returns true if an Origin header is ours: http://HOST, or http or https with one of `allowed`.
bool origin_is_ours(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed);

/// The host and the path that a request is for.
struct web_target {
    std::string_view host;
    std::string_view path;
};

/// Reads a request's target, which may be a whole address ("http://pi.lan/rpc", as to a proxy), and its Host
/// header, which stands behind that. What is neither an address nor a path is a path that is not there.
web_target target_of(std::string_view target, std::string_view host);

/// Returns what follows "Bearer " in an Authorization header; empty for others.
std::string_view bearer_of(std::string_view authorization);

} // namespace tactor::net
