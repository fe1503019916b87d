// SPDX-License-Identifier: MIT
/// \file
/// Finds the process that holds a port, in /proc.
#pragma once

#include <cstdint>
#include <string>

#include <sys/types.h>

namespace tactor::net {

/// Returns "tactor, process 1234"; the number alone where the process has no name.
std::string process_name(pid_t pid);

/// Returns the name of the process that listens at a port of TCP (`stream`) or is bound to one of UDP;
/// "another user's process" where the system does not show it; empty where no socket has that port.
std::string find_port_holder(std::uint16_t port, bool stream);

} // namespace tactor::net
