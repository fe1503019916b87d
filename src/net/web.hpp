// SPDX-License-Identifier: MIT
/// \file
/// Connections to browsers, and a server for a single page. A connection serves one HTTP request, or becomes
/// a WebSocket with text messages in both directions.
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

/// Makes a connection from an accepted socket. Sets the socket to send small messages without delay. Returns
/// null if the peer has disconnected. The connection runs in the context's thread. For `allowed_hosts`, see
/// `allowed` of is_server_host().
/// `socket_path`: path of the WebSocket, a literal.
std::shared_ptr<connection> connect_browser(boost::asio::io_context& io,
                                            boost::asio::generic::stream_protocol::socket accepted,
                                            const message_limits& l, std::vector<std::string> allowed_hosts,
                                            std::string_view socket_path = "/rpc");

/// A document for browsers, made by bundle.py. Its texts exist until the program ends.
struct page_document {
    std::string_view text;
    std::string_view policy; ///< policy that allows the document's own script and style
    std::string_view gzip;   ///< compressed text
};

/// Makes a reply with a document. The document may run its own script and style, and connect only to `host`,
/// the name of this server in the browser.
web_reply make_page(const page_document& document, std::string_view host);

/// Replies that the server is full. Sends as much of the reply as the socket accepts at once.
void reject_client(int socket);

/// Returns the reply to a browser for which no descriptor is free.
std::string no_descriptor_reply();

/// A server of a single document. Each browser that shows the document has a WebSocket. The server runs on
/// its own thread, which inherits the caller's blocked signals.
class page_server {
public:
    /// Number of a WebSocket. Each number is used only once.
    using visitor = unsigned;

    /// Handlers. They are called on the server's thread.
    struct handlers {
        /// Handles a text message. Returns false to close the connection.
        std::function<bool(visitor, std::string_view)> on_text;
        /// Called when the visitor has disconnected.
        std::function<void(visitor)> on_leave;
    };

    /// Starts the server. `listening` is a listening TCP socket.
    page_server(owned_fd listening, const page_document& document, handlers h);
    /// Closes all connections when everything has been sent, or after one second.
    ~page_server();
    page_server(const page_server&) = delete;
    page_server& operator=(const page_server&) = delete;

    /// Sends a text. Messages to a visitor keep their order. Messages to a visitor that has disconnected are
    /// lost. Any thread.
    void send(visitor to, std::string text);
    /// Closes a connection after all earlier messages have been sent. Any thread.
    void finish(visitor v);

private:
    void take(listener::socket_type s);

    // No concurrency hint of 1: with it, messages of this thread would wait behind those of other threads.
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
