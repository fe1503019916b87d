// SPDX-License-Identifier: MIT
/// \file
/// A browser's connection: a request, or a WebSocket with text messages in both directions. It runs in the
/// context's thread.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>

#include "net/connection.hpp"

namespace tactor::net {

/// Takes an accepted socket, and lets it send small messages without delay. Returns null if the peer is gone.
/// `allowed_hosts`: as host_is_ours() has them.
std::shared_ptr<connection> connect_browser(boost::asio::io_context& io,
                                            boost::asio::generic::stream_protocol::socket accepted,
                                            const message_limits& l, std::vector<std::string> allowed_hosts);

/// A document for browsers, as bundle.py makes it. Its texts live on.
struct page_document {
    std::string_view text;
    std::string_view policy; ///< that its own script and style may run
    std::string_view gzip;   ///< the text, compressed
};

/// Makes a document for a browser that calls this server `host`: it may run its own script and style, and
/// talk to that host only.
web_reply make_page(const page_document& document, std::string_view host);

/// Sends a browser on this socket the reply that there is no place, as far as the socket takes it.
void turn_away(int socket);

/// Returns the whole reply to a browser for which no descriptor is left.
std::string no_descriptors_for_browsers();

} // namespace tactor::net
