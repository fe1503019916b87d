// SPDX-License-Identifier: MIT
/// \file
/// Documents that are whole in themselves.
#pragma once

#include <string>
#include <string_view>

#include "net/web_connection.hpp"

namespace tactor::net {

/// A document for a browser that calls this server `host`: it may run its own script and style, which carry
/// nonce="NONCE", and talk to that host only.
web_reply make_page(std::string_view document, std::string_view host);

/// Tells a browser on this socket that there is no place, as far as it takes it.
void turn_away(int socket);

/// What browsers are told for whom no descriptor is left: a whole reply.
std::string no_descriptors_for_browsers();

} // namespace tactor::net
