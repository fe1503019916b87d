// SPDX-License-Identifier: MIT
/// \file
/// The service with its sockets and signals, and the notifications to the service manager that started it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "net/access.hpp"
#include "net/listen.hpp"
#include "options/serve.hpp"
#include "server/service.hpp"

namespace tactor::server {

struct endpoint_options {
    std::function<std::string()> socket; ///< returns the socket's path; called if no socket is inherited
    mode_t mode = 0600;
    std::optional<gid_t> group = {};
    std::optional<net::host_and_port> tcp = {};
    std::optional<net::host_and_port> http = {};
    std::optional<net::host_and_port> osc = {};
    std::optional<net::host_and_port> bhaptics = {};
    std::vector<std::string> allow_hosts = {};
    std::vector<std::string> osc_peers = {}; ///< address prefixes
};

/// Listening sockets, their addresses, and the machines and names that they accept.
struct endpoints {
    net::owned_fd socket;
    std::string socket_path;
    /// Device and inode of the socket file that this process created. At the end, the file is removed if it
    /// still has these numbers.
    std::optional<std::pair<dev_t, ino_t>> own_socket = {};
    net::owned_fd tcp;
    std::string tcp_address; ///< empty if off
    net::owned_fd http;
    std::string http_address; ///< empty if off
    net::owned_fd osc;
    std::string osc_address; ///< empty: off
    net::owned_fd bhaptics;
    std::string bhaptics_address; ///< empty: off
    /// HTTP: other names of this server, and of pages that may use it.
    std::vector<std::string> allow_hosts = {};
    /// OSC and bHaptics: other machines that are accepted.
    std::vector<net::address_prefix> osc_peers = {};
};

/// Returns the first line of token_file, or "" if token_file is not set.
/// \throws error (bad_input) if the file cannot be read, if other users may read it, or if the line is empty
///         or too long.
std::string read_token(const options::serve_settings& s);

/// Opens the listening sockets, or uses inherited sockets.
/// \throws error: see net/listen.hpp; bad_input for an inherited socket of a kind that its name does not
///         allow, and for a text that is not an address prefix.
endpoints open_endpoints(const endpoint_options& o);

/// Removes the file of the socket that this process created.
void remove_socket(const endpoints& at) noexcept;

/// Runs the service until `signals` is readable. Then fades out and notifies all clients. Calls `listening`
/// once, when all sockets accept connections.
void serve(const endpoints& at, service_options o, stream_options s, int signals,
           const std::function<void()>& listening);

} // namespace tactor::server
