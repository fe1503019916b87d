// SPDX-License-Identifier: MIT
/// \file
/// [serve] of a configuration.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/setup.hpp>

namespace tactor::options {

/// Addresses and limits of a service. An absent value is the service's default.
struct serve_settings {
    std::optional<std::string> socket = {}; ///< path of the Unix socket
    std::optional<std::string> tcp = {};    ///< "[HOST:]PORT", as for osc and http
    std::optional<std::string> osc = {};
    std::optional<std::string> http = {};
    std::optional<std::string> token_file = {};
    std::vector<std::string> allow_hosts = {};
    std::vector<std::string> osc_peers = {};
    std::optional<double> max_level_dbfs = {};
    std::optional<double> idle_stop_s = {};
    std::optional<unsigned> max_clients = {};
    std::optional<unsigned> kept_clients = {};     ///< of these, places for the Unix socket alone
    std::optional<unsigned> max_strokes = {};      ///< of one client at once
    std::optional<unsigned> max_live_strokes = {}; ///< of these, live ones
    std::optional<unsigned> max_points_per_s = {}; ///< of one client
    std::optional<double> max_stroke_s = {};
    std::optional<unsigned> max_message_bytes = {};
    std::optional<unsigned> max_nesting = {};
    std::optional<double> max_message_s = {};
    std::optional<unsigned> max_unread_bytes = {};         ///< that wait for one client
    std::optional<unsigned> max_all_unread_bytes = {};     ///< that wait for all together
    std::optional<unsigned> max_all_unfinished_bytes = {}; ///< of messages of all that have not come whole
};

/// Reads and checks setup::serve. \throws error (bad_input) with file, line and column.
[[nodiscard]] serve_settings read_serve(const std::vector<written_value>& said);

} // namespace tactor::options
