// SPDX-License-Identifier: MIT
/// \file
/// The table [serve] of a configuration.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/setup.hpp>

namespace tactor::options {

/// Limits for the requests of each client, and of all clients together.
struct serve_limits {
    std::size_t max_clients = 64;
    std::size_t kept_clients = 8; ///< how many of max_clients are reserved for the Unix socket
    std::size_t max_strokes = 64; ///< strokes of one client at once, including those that are being planned
    std::size_t max_live_strokes = 4; ///< how many of max_strokes may be live
    double max_points_per_s = 2000.0; ///< points of a client; also the greatest number at once
    double max_stroke_s = 600.0;
    std::size_t max_message_bytes = 1U << 20;
    std::size_t max_nesting = 64;
    double max_message_s = 10.0; ///< time for receiving a message; also until the first one arrives
    std::size_t max_unread_bytes = 4U << 20; ///< bytes that may wait to be sent to a client
};

/// Addresses and limits of a service. If a value is not set, the service uses its default.
struct serve_settings {
    std::optional<std::string> socket = {}; ///< path of the Unix socket
    std::optional<std::string> tcp = {};    ///< "[HOST:]PORT", as for the next three
    std::optional<std::string> osc = {};
    std::optional<std::string> http = {};
    std::optional<std::string> bhaptics = {};
    std::optional<std::string> token_file = {};
    std::vector<std::string> allow_hosts = {};
    std::vector<std::string> osc_peers = {};
    std::optional<double> max_level_dbfs = {};
    source_place max_level_at = {}; ///< place of max_level_dbfs in its file
    std::optional<double> idle_stop_s = {};
    serve_limits limits = {};
};

/// Reads and checks setup::serve.
/// \throws error (bad_input) with file, line and column.
[[nodiscard]] serve_settings read_serve(const std::vector<written_value>& entries);

/// Returns the limits with their names in [serve].
[[nodiscard]] std::vector<std::pair<std::string_view, double>> list_limits(const serve_limits& l);

} // namespace tactor::options
