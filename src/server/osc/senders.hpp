// SPDX-License-Identifier: MIT
/// \file
/// What is kept of those that send OSC.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "server/osc/clients.hpp"

namespace tactor::server {

/// A request to the service that was not answered.
struct osc_clients::asked_for {
    std::string address;
    std::string method;
    std::int32_t number = 0;
};

/// A stroke with a number of the sender's choice.
struct osc_clients::drawn {
    std::optional<std::uint32_t> stroke = {};        ///< the service's number, once it is known
    std::optional<std::int64_t> begins_unix_ns = {}; ///< of a live stroke, its time tag
    bool held = false;                               ///< that time has not come
    bool is_loud = false;                            ///< a point was above intensity 1, which was said
    std::deque<osc_request> waiting = {};            ///< until its number is known
};

struct osc_clients::sender {
    client_number client = 0;
    std::uint64_t last_id = 0;
    std::map<std::uint64_t, asked_for> asked = {};
    std::map<std::int32_t, drawn> drawn_as = {};
    std::map<std::uint32_t, std::int32_t> numbers = {}; ///< of strokes that go on: the service's to its own
    std::size_t held = 0;
    std::optional<held_messages::iterator> unsubscribes = {}; ///< when its subscription ends
    std::uint16_t port = 0;                                   ///< that it goes to
    std::shared_ptr<client_link> way_back = {};

    bool idle() const
    {
        return asked.empty() && drawn_as.empty() && numbers.empty() && held == 0 && !unsubscribes;
    }
};

} // namespace tactor::server
