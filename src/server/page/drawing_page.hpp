// SPDX-License-Identifier: MIT
/// \file
/// The page to draw on.
#pragma once

#include <string_view>

#include "net/web_connection.hpp"

namespace tactor::server {

/// The page for a browser that calls this server `host`: it may run its own script, and talk to that host
/// only.
net::web_reply drawing_page(std::string_view host);

} // namespace tactor::server
