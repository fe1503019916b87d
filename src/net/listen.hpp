// SPDX-License-Identifier: MIT
/// \file
/// Sockets to listen on: bound here, or inherited from whoever started the process.
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

/// "[HOST:]PORT", the HOST of IPv6 in brackets. \throws error (bad_input) that names `what`.
host_and_port parse_host(std::string_view text, const std::string& what);

/// A socket that listens at `path`, which only its user (and with `group` that group, where it exists) can
/// connect to from the first moment on, under any umask. What a process that is gone left there is replaced.
/// \throws error: not_available when somebody listens there (who), bad_input for what is no socket and for
///         names that are too long, runtime for what the system refuses.
owned_fd listen_unix(const std::string& path, mode_t mode, std::optional<gid_t> group);

/// A socket that listens at each address of a host. \throws error like listen_unix().
owned_fd listen_tcp(const host_and_port& at, const std::string& what);

/// A socket for datagrams to an address of a host. \throws error like listen_unix().
owned_fd bind_udp(const host_and_port& at, const std::string& what);

/// "127.0.0.1:4001", "[::1]:4001" of what a TCP socket is bound to.
std::string local_address(int fd);
/// The same of its host alone.
bool is_loopback(int fd);
/// Whether it is of the family AF_UNIX, a stream, and listens.
bool is_unix_listener(int fd);
bool is_tcp_listener(int fd);
/// Whether it takes datagrams of IP at a port of its own.
bool is_bound_udp(int fd);
/// The path that a Unix socket is bound to; empty for none.
std::string bound_path(int fd);

/// What systemd handed over, by FileDescriptorName; taken from the environment once, so that children get
/// none.
std::vector<std::pair<std::string, owned_fd>> inherited_sockets();

/// Sends one datagram such as "READY=1" to NOTIFY_SOCKET; nothing where there is none.
void notify_manager(std::string_view text) noexcept;

/// Returns "tactor, process 1234"; the number alone where the process has no name.
std::string process_name(pid_t pid);

/// Returns the name of the process that listens at a port of TCP (`stream`) or is bound to one of UDP;
/// "another user's process" where the system does not show it; empty where no socket has that port.
std::string find_port_holder(std::uint16_t port, bool stream);

} // namespace tactor::net
