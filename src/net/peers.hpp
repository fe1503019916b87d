// SPDX-License-Identifier: MIT
/// \file
/// Whose datagrams are heard. Pure functions.
#pragma once

#include <string>
#include <vector>

#include <boost/asio/ip/address.hpp>

namespace tactor::net {

/// An IPv4 address within IPv6 as what it is; any other as it is.
boost::asio::ip::address plain(const boost::asio::ip::address& a);

/// The addresses that begin with the same bits.
struct address_prefix {
    boost::asio::ip::address address;
    unsigned bits = 0;
};

/// "192.168.1.0/24", "fd00::/8", or an address alone. \throws error (bad_input) that names `what`.
address_prefix parse_prefix(const std::string& text, const std::string& what);

/// This machine's own loopback addresses, and those of `peers`. An IPv4 address within IPv6 counts as IPv4.
bool is_heard(const boost::asio::ip::address& from, const std::vector<address_prefix>& peers);

} // namespace tactor::net
