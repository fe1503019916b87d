// SPDX-License-Identifier: MIT
/// \file
/// The service with its sockets and signals, and the manager that started it.
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
    std::function<std::string()> socket; ///< returns the path, if none was inherited
    mode_t mode = 0600;
    std::optional<gid_t> group = {};
    std::optional<net::host_and_port> tcp = {};
    std::optional<net::host_and_port> http = {};
    std::optional<net::host_and_port> osc = {};
    std::optional<net::host_and_port> bhaptics = {};
    std::vector<std::string> allow_hosts = {};
    std::vector<std::string> osc_peers = {}; ///< prefixes
};

/// Listening sockets, their addresses, and the peers that they accept.
struct endpoints {
    net::owned_fd socket;
    std::string socket_path;
    /// Device and number of the file that was bound here. It is removed at the end if it is still that file.
    std::optional<std::pair<dev_t, ino_t>> own_socket = {};
    net::owned_fd tcp;
    std::string tcp_address; ///< empty: off
    net::owned_fd http;
    std::string http_address; ///< empty: off
    net::owned_fd osc;
    std::string osc_address; ///< empty: off
    net::owned_fd bhaptics;
    std::string bhaptics_address; ///< empty: off
    /// HTTP: other names of this server, and of pages that may use it.
    std::vector<std::string> allow_hosts = {};
    /// OSC and bHaptics: other machines that are accepted.
    std::vector<net::address_prefix> osc_peers = {};
};

/// Returns the text of token_file without its line end; empty without such a file.
/// \throws error (bad_input) for a file that others may read, and for an empty one.
std::string read_token(const options::serve_settings& s);

/// Binds sockets, or uses inherited ones.
/// \throws error: see net/listen.hpp; bad_input for inherited sockets of a kind that does not fit their
///         names, and for a text that is not a prefix.
endpoints open_endpoints(const endpoint_options& o);

/// Removes the socket that was bound here.
void remove_socket(const endpoints& at) noexcept;

/// Serves until `signals` is readable; then fades out and notifies all clients. Calls `listening` once, when
/// all sockets accept.
void serve(const endpoints& at, service_options o, stream_options s, int signals,
           const std::function<void()>& listening);

} // namespace tactor::server
