// SPDX-License-Identifier: MIT
/// \file
/// What one client, and all together, may ask of the service.
#pragma once

#include <cstddef>

namespace tactor::server {

struct service_limits {
    std::size_t max_clients = 128;
    std::size_t kept_clients = 8;     ///< of these, places for the Unix socket alone
    std::size_t max_strokes = 64;     ///< of one client at once, those that are being planned included
    std::size_t max_live_strokes = 4; ///< of these, live ones
    double max_points_per_s = 2000.0; ///< of one client; as many at once
    double max_stroke_s = 600.0;
    std::size_t max_message_bytes = 1U << 20;
    std::size_t max_nesting = 64;
    double max_message_s = 10.0;             ///< for a message to be complete, and for the first one to come
    std::size_t max_unread_bytes = 4U << 20; ///< that wait for one client
    std::size_t max_all_unread_bytes = 64U
                                       << 20; ///< for all, and as many of requests that wait to be planned
    std::size_t max_all_unfinished_bytes = 32U << 20; ///< of messages that have not come whole, of all
};

} // namespace tactor::server
