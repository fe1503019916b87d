// SPDX-License-Identifier: MIT
/// \file
/// Browsers: their connections, each a request or a WebSocket with text messages in both directions, and a
/// server of one page.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>

#include "net/connection.hpp"
#include "net/listen.hpp"

namespace tactor::net {

/// Makes a connection of an accepted socket, which then sends small messages without delay. Returns null if
/// the peer is gone. The connection runs in the context's thread. `allowed_hosts`: as in host_is_ours().
/// `socket_path`: path of the WebSocket, a literal.
std::shared_ptr<connection> connect_browser(boost::asio::io_context& io,
                                            boost::asio::generic::stream_protocol::socket accepted,
                                            const message_limits& l, std::vector<std::string> allowed_hosts,
                                            std::string_view socket_path = "/rpc");

/// A document for browsers, made by bundle.py. Its texts are never freed.
struct page_document {
    std::string_view text;
    std::string_view policy; ///< policy that lets its own script and style run
    std::string_view gzip;   ///< compressed text
};

/// Makes a document for a browser that calls this server `host`: it may run its own script and style, and
/// talk to that host only.
web_reply make_page(const page_document& document, std::string_view host);

/// Replies to the browser on this socket that no place is free, as far as the socket takes the reply.
void turn_away(int socket);

/// Returns the reply to a browser for which no descriptor is free.
std::string no_descriptors_for_browsers();

/// A server of a document, with a WebSocket to each browser that shows it. Runs on its own thread, which
/// inherits the caller's blocked signals.
class page_server {
public:
    /// Number of a WebSocket. Numbers are not reused.
    using visitor = unsigned;

    /// Handlers, called on the page's thread.
    struct handlers {
        /// Handles a text message. Returns false to close the connection.
        std::function<bool(visitor, std::string_view)> on_text;
        /// Called when the visitor is gone.
        std::function<void(visitor)> on_leave;
    };

    /// Starts the server. `listening` is a TCP socket.
    page_server(owned_fd listening, const page_document& document, handlers h);
    /// Closes all connections when everything has been sent, or after a second.
    ~page_server();
    page_server(const page_server&) = delete;
    page_server& operator=(const page_server&) = delete;

    /// Sends a text. Any thread. Messages to a visitor keep their order; those to a visitor that is gone are
    /// lost.
    void send(visitor to, std::string text);
    /// Closes a connection after the messages sent before. Any thread.
    void finish(visitor v);

private:
    void take(listener::socket_type s);

    // No concurrency hint of 1, which would put this thread's messages behind those of other threads.
    boost::asio::io_context io_;
    owned_fd fd_;
    page_document document_;
    handlers calls_;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    listener door_;
    std::set<std::shared_ptr<connection>> all_;
    std::map<visitor, std::shared_ptr<connection>> visitors_;
    visitor last_ = 0;
    std::thread thread_;
};

} // namespace tactor::net
