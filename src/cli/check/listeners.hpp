// SPDX-License-Identifier: MIT
/// \file
/// Where running services of this tool can be reached.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/alsa.hpp>

namespace tactor::cli {

/// An endpoint: a socket's path, "127.0.0.1:4001", or "osc 127.0.0.1:4002".
struct endpoint {
    std::string at = {};
    bool beyond_loopback = false;
};

/// A process `tactor serve`.
struct listening_service {
    process_info who = {};
    bool may_look = true; ///< its descriptors may be read: only its user's and root's may
    std::vector<endpoint> endpoints = {};
};

/// An address as /proc/net/tcp (8 digits) and tcp6 (32) have it, "0100007F:0FA1" with the port; nothing there
/// (an empty `at`) for what is none.
endpoint endpoint_of(std::string_view hexadecimal);

/// By process number, from files under `root`/proc. What cannot be read is left out. Blocks shortly.
std::vector<listening_service> find_services(const std::filesystem::path& root);

} // namespace tactor::cli
