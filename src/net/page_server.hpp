// SPDX-License-Identifier: MIT
/// \file
/// One document for browsers, and a WebSocket to each that shows it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "net/listen.hpp"

namespace tactor::net {

/// Serves on a thread of its own, which inherits the signals that its maker has blocked.
class page_server {
public:
    /// A WebSocket; none has the number of another.
    using visitor = unsigned;

    /// Called on the page's thread.
    struct handlers {
        /// A text message. False: the connection is to be closed.
        std::function<bool(visitor, std::string_view)> said;
        /// It is gone.
        std::function<void(visitor)> left;
    };

    /// `listening` is a TCP socket; the document is as make_page() wants it, and must live as long.
    page_server(owned_fd listening, std::string_view document, handlers h);
    /// Ends all connections, when what was sent is through, or after a second.
    ~page_server();
    page_server(const page_server&) = delete;
    page_server& operator=(const page_server&) = delete;

    /// Any thread. Messages to a visitor come in the order in which they were sent; to one that is gone they
    /// are lost.
    void send(visitor to, std::string text);
    /// Any thread: closes the connection behind what was sent.
    void finish(visitor v);

    struct state;

private:
    std::unique_ptr<state> state_;
};

} // namespace tactor::net
