// SPDX-License-Identifier: MIT
/// \file
/// Listening sockets. They are created here, or inherited from the process that started this one.
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

/// Parses "[HOST:]PORT". An IPv6 address as HOST is in brackets.
/// \throws error (bad_input) that names `what`.
host_and_port parse_host(std::string_view text, const std::string& what);

/// Listens at `path`. Under any umask, and already during creation, only this user and the group `group`, if
/// set, can connect. Replaces the socket of a process that has ended.
/// \throws error: not_available with the name of the process that already listens there; bad_input for a file
///         that is not a socket and for a name that is too long; runtime for a failed system call.
owned_fd listen_unix(const std::string& path, mode_t mode, std::optional<gid_t> group);

/// Listens at the first address of a host.
/// \throws the errors of listen_unix().
owned_fd listen_tcp(const host_and_port& at, const std::string& what);

/// Binds a datagram socket to the first address of a host.
/// \throws the errors of listen_unix().
owned_fd bind_udp(const host_and_port& at, const std::string& what);

/// Returns the address to which a TCP socket is bound, in the form "127.0.0.1:4001" or "[::1]:4001".
std::string local_address(int fd);
/// Returns the address of a socket's peer without the port, in the form "192.168.1.7" or "fe80::1%eth0". An
/// IPv4-mapped IPv6 address becomes IPv4. Returns "" if the peer has disconnected.
std::string peer_address(int fd);
/// Returns true if the peer is on the loopback interface.
bool is_loopback(int fd);
/// Returns true if the socket is a listening stream socket of the family AF_UNIX.
bool is_unix_listener(int fd);
bool is_tcp_listener(int fd);
/// Returns true if the socket is a UDP socket that is bound to a port.
bool is_bound_udp(int fd);
/// Returns the path to which a Unix socket is bound, or "" if it has no path.
std::string bound_path(int fd);

/// Returns the sockets that systemd passed to this process, with their FileDescriptorName. Removes the
/// environment variables, so that children do not see them. A second call returns an empty list.
std::vector<std::pair<std::string, owned_fd>> take_inherited_sockets();

/// Sends a datagram such as "READY=1" to NOTIFY_SOCKET, if this variable is set.
void notify_manager(std::string_view text) noexcept;

/// Returns the name of the process that listens at a TCP port (if `stream`) or is bound to a UDP port.
/// Returns "another user's process" if the system hides the name, and "" if no socket has this port.
std::string find_port_holder(std::uint16_t port, bool stream);

} // namespace tactor::net
