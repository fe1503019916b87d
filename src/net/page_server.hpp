// SPDX-License-Identifier: MIT
/// \file
/// A document for browsers, and a WebSocket to each that shows it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "net/listen.hpp"

namespace tactor::net {

struct page_document;

/// Server on its own thread, which inherits the signals that its maker has blocked.
class page_server {
public:
    /// Number of a WebSocket. Numbers are not reused.
    using visitor = unsigned;

    /// Handlers, called on the page's thread.
    struct handlers {
        /// Handles a text message. Returns false to close the connection.
        std::function<bool(visitor, std::string_view)> said;
        /// The visitor is gone.
        std::function<void(visitor)> left;
    };

    /// Starts the server. `listening` is a TCP socket.
    page_server(owned_fd listening, const page_document& document, handlers h);
    /// Ends all connections when everything is sent, or after a second.
    ~page_server();
    page_server(const page_server&) = delete;
    page_server& operator=(const page_server&) = delete;

    /// Sends a text. Any thread. Messages to a visitor keep their order; those to a visitor that is gone are
    /// lost.
    void send(visitor to, std::string text);
    /// Closes the connection after the sent messages. Any thread.
    void finish(visitor v);

    struct state;

private:
    std::unique_ptr<state> state_;
};

} // namespace tactor::net
