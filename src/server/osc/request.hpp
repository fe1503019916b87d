// SPDX-License-Identifier: MIT
/// \file
/// What a message of OSC asks for, in the words of the protocol. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "net/osc.hpp"
#include "net/rpc.hpp"

namespace tactor::server {

struct osc_request {
    std::string address;
    std::string method; ///< of the protocol; empty: a button's release, which asks for nothing
    net::json params = net::json::object();
    std::int32_t number = 0;                  ///< the sender's for its stroke; 0: none
    std::optional<std::int64_t> unix_ns = {}; ///< its time tag
    std::uint16_t port = 0;                   ///< where a subscriber listens; 0: where it sends from
};

/// Whether a server sends such messages: they are never answered, so that two servers do not talk for ever.
bool is_servers_own(std::string_view address);

/// Address of the message that fades everything out.
constexpr std::string_view osc_stop = "/tactor/stop";

/// \throws fault_error for addresses that are not known, and for wrong values.
osc_request read_osc(const net::osc_message& m);

} // namespace tactor::server
