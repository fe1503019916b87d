// SPDX-License-Identifier: MIT
/// \file
/// A browser's connection: a request, or a WebSocket with text messages in both directions, within limits.
/// It runs in the context's thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/tcp.hpp>

#include "net/line_connection.hpp"

namespace tactor::net {

struct web_reply {
    unsigned status = 200;
    std::string type = "text/plain; charset=utf-8";
    std::string body = {};
    std::string policy = {}; ///< Content-Security-Policy; empty: the page may load nothing
};

/// Returns an accepted socket as a TCP socket that does not delay small messages; nothing if the peer is
/// gone.
std::optional<boost::asio::ip::tcp::socket> web_socket(boost::asio::io_context& io,
                                                       line_connection::socket_type taken);

class web_connection {
public:
    using socket_type = boost::asio::ip::tcp::socket;

    struct handlers {
        /// Answers GET of a path. `host`: the server's name in the browser; `token`: of "Authorization:
        /// Bearer".
        std::function<web_reply(std::string_view path, std::string_view host, std::string_view token)> get;
        /// Returns true if there is a place for a WebSocket. From then on `text` is called, and `closed` is
        /// its end.
        std::function<bool()> upgrade;
        /// Handles a text message. Returns false to close the connection.
        std::function<bool(std::string_view)> text;
        /// Called once, when the socket is closed. The connection may be forgotten.
        std::function<void()> closed;
        /// See line_connection::handlers::met.
        std::function<bool()> met = {};
        /// See line_connection::handlers::large.
        std::function<void(std::string text, std::function<void(bool)> done)> large = {};
        /// See line_connection::handlers::urgent.
        std::function<bool(std::string_view)> urgent = {};
    };

    web_connection(socket_type s, const line_limits& l, shared_by_peers& all,
                   std::vector<std::string> allowed_hosts);
    ~web_connection();
    web_connection(const web_connection&) = delete;
    web_connection& operator=(const web_connection&) = delete;

    void start(handlers h);
    /// Queues a text message. Drops a peer that lets too much wait.
    void send(std::string text);
    /// Stops reading, and closes when everything is written, or after a second.
    void finish();
    /// Closes in the same way, with status 1008 and a reason of at most 123 bytes.
    void turn_out(const char* why);
    /// Returns the bytes that the peer has not read.
    std::size_t waiting() const noexcept;

    struct session;

private:
    std::shared_ptr<session> session_;
};

/// Makes a document for a browser that calls this server `host`. The document may run its own script and
/// style, which carry nonce="NONCE", and talk to that host only.
web_reply make_page(std::string_view document, std::string_view host);

/// Sends a browser on this socket the reply that there is no place, as far as the socket takes it.
void turn_away(int socket);

/// Returns the whole reply to a browser for which no descriptor is left.
std::string no_descriptors_for_browsers();

} // namespace tactor::net
