// SPDX-License-Identifier: MIT
/// \file
/// One browser's connection: a request, or a WebSocket whose text messages go both ways, within limits. One
/// thread: the context's.
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
    std::string policy = {}; ///< Content-Security-Policy; empty: nothing may be loaded
};

/// What a listener took, as a socket of TCP that does not hold small messages back; none where it is gone.
std::optional<boost::asio::ip::tcp::socket> web_socket(boost::asio::io_context& io,
                                                       line_connection::socket_type taken);

class web_connection {
public:
    using socket_type = boost::asio::ip::tcp::socket;

    struct handlers {
        /// GET of a path; `host` as the browser calls us, `token` of "Authorization: Bearer".
        std::function<web_reply(std::string_view path, std::string_view host, std::string_view token)> get;
        /// Whether there is a place for a WebSocket. From then on there is `text`, and `closed` is its end.
        std::function<bool()> upgrade;
        /// A text message. False: the connection is to be closed.
        std::function<bool(std::string_view)> text;
        /// Once, when the socket is closed. The connection may be forgotten.
        std::function<void()> closed;
        /// Whether what came was the first message that is owed; none: any that is not empty is.
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
    /// Queues a text message. A peer that lets too much wait is dropped.
    void send(std::string text);
    /// Reads nothing more, closes when all is written, or after a second.
    void finish();
    /// The same, with 1008 and a reason of at most 123 bytes.
    void turn_out(const char* why);
    /// Bytes that the peer has not taken.
    std::size_t waiting() const noexcept;

    struct session;

private:
    std::shared_ptr<session> session_;
};

/// Makes a document for a browser that calls this server `host`: it may run its own script and style, which
/// carry nonce="NONCE", and talk to that host only.
web_reply make_page(std::string_view document, std::string_view host);

/// Tells a browser on this socket that there is no place, as far as it takes it.
void turn_away(int socket);

/// Returns the whole reply to a browser for which no descriptor is left.
std::string no_descriptors_for_browsers();

} // namespace tactor::net
