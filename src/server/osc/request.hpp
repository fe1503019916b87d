// SPDX-License-Identifier: MIT
/// \file
/// Requests in messages of OSC, in the words of the protocol. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "net/osc.hpp"
#include "net/rpc.hpp"

namespace tactor::server {

struct osc_request {
    std::string method; ///< method of the protocol; empty: a button's release, which asks for nothing
    net::json params = net::json::object();
    std::int32_t number = 0; ///< the sender's number for its stroke; 0: none
    std::uint16_t port = 0;  ///< port at which a subscriber listens; 0: the port that it sends from
};

/// Returns true for messages that a server sends: they are never answered, so that two servers do not talk
/// for ever.
bool is_servers_own(std::string_view address);

/// Address of the message that fades everything out.
constexpr std::string_view osc_stop = "/tactor/stop";

/// Reads a message. \throws fault_error for addresses that are not known, and for wrong values.
osc_request read_osc(const net::osc_message& m);

} // namespace tactor::server
