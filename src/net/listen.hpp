// SPDX-License-Identifier: MIT
/// \file
/// Listening sockets: bound here, or inherited from the process that started this one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "core/owned.hpp"

namespace tactor::net {

using detail::owned_fd;

struct host_and_port {
    std::string host = "127.0.0.1";
    std::uint16_t port = 0;
};

/// Parses "[HOST:]PORT"; an IPv6 HOST is in brackets.
/// \throws error (bad_input) that names `what`.
host_and_port parse_host(std::string_view text, const std::string& what);

/// Listens at `path`. From the first moment on, under any umask, only this user (and the group `group`, if
/// any) can connect. Replaces the socket of a dead process.
/// \throws error: not_available with the name of a process that listens there, bad_input for a file that is
///         not a socket and for names that are too long, runtime for errors of the system.
owned_fd listen_unix(const std::string& path, mode_t mode, std::optional<gid_t> group);

/// Listens at each address of a host.
/// \throws error like listen_unix().
owned_fd listen_tcp(const host_and_port& at, const std::string& what);

/// Binds a socket for datagrams to an address of a host.
/// \throws error like listen_unix().
owned_fd bind_udp(const host_and_port& at, const std::string& what);

/// Returns the address to which a TCP socket is bound, as "127.0.0.1:4001" or "[::1]:4001".
std::string local_address(int fd);
/// Returns the address of a socket's peer without its port, as "192.168.1.7" or "fe80::1%eth0"; an IPv4
/// address within IPv6 as IPv4. Empty: the peer is gone.
std::string peer_address(int fd);
/// Returns true if the peer is on the loopback interface.
bool is_loopback(int fd);
/// Returns true if the socket is of the family AF_UNIX, a stream, and listens.
bool is_unix_listener(int fd);
bool is_tcp_listener(int fd);
/// Returns true if the socket takes IP datagrams and is bound to a port.
bool is_bound_udp(int fd);
/// Returns the path to which a Unix socket is bound; empty for none.
std::string bound_path(int fd);

/// Returns the sockets that systemd passed, by FileDescriptorName. Removes them from the environment, so that
/// children do not inherit them. A second call returns none.
std::vector<std::pair<std::string, owned_fd>> inherited_sockets();

/// Sends one datagram such as "READY=1" to NOTIFY_SOCKET, if there is one.
void notify_manager(std::string_view text) noexcept;

/// Returns the name of the process that listens at a TCP port (`stream`) or is bound to a UDP port. Returns
/// "another user's process" if the system hides it; empty if no socket has that port.
std::string find_port_holder(std::uint16_t port, bool stream);

} // namespace tactor::net
