// SPDX-License-Identifier: MIT
/// \file
/// The service with its sockets, signals and whoever started it.
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
    std::function<std::string()> socket; ///< gives the path, where none was inherited
    mode_t mode = 0600;
    std::optional<gid_t> group = {};
    std::optional<net::host_and_port> tcp = {};
    std::optional<net::host_and_port> http = {};
    std::optional<net::host_and_port> osc = {};
};

/// What is listened on.
struct endpoints {
    net::owned_fd socket;
    std::string socket_path;
    /// Device and number of the file that was bound here, and is removed at the end, if it is that one still.
    std::optional<std::pair<dev_t, ino_t>> own_socket = {};
    net::owned_fd tcp;
    std::string tcp_address; ///< empty: off
    net::owned_fd http;
    std::string http_address; ///< empty: off
    net::owned_fd osc;
    std::string osc_address; ///< empty: off
};

/// Who else may come to the endpoints of the network.
struct network_options {
    std::vector<std::string> allow_hosts =
        {}; ///< HTTP: other names of this server, and pages that may use it
    std::vector<net::address_prefix> osc_peers = {}; ///< OSC: other machines that are heard
};

/// Returns who else may come. \throws error (bad_input) for what is no prefix.
network_options settle_network(const options::serve_settings& s);

service_limits settle_limits(const options::serve_settings& s);

/// Returns the text of token_file without its line end; empty for none. \throws error (bad_input) for a file
/// that others may read, and for an empty one.
std::string read_token(const options::serve_settings& s);

/// Binds, or takes what was inherited. \throws error: see net/listen.hpp; bad_input for inherited sockets
/// that are not what their names say.
endpoints open_endpoints(const endpoint_options& o);

/// Removes what was bound here.
void remove_socket(const endpoints& at) noexcept;

/// Serves until `signals` is readable; then fades out and tells everybody.
/// `listening` is called once when all accept.
void serve(const endpoints& at, service_options o, stream_options s, network_options w, int signals,
           const std::function<void()>& listening);

} // namespace tactor::server
