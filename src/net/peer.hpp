// SPDX-License-Identifier: MIT
/// \file
/// The two sides of a connection: what a server sends to a peer, and what the peer's connection calls.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tactor::net {

/// Bytes of a message that is handled in the thread of the sockets. A larger one is given away.
constexpr std::size_t large_message = 64U << 10;

/// The way to a peer, over a connection of any kind.
class peer {
public:
    peer() = default;
    peer(const peer&) = delete;
    peer& operator=(const peer&) = delete;
    virtual ~peer() = default;

    /// Queues a message. Drops a peer that lets too much wait.
    virtual void send(std::string message) = 0;
    /// Queues a message of any size that the peer asked for. Beside it as much may wait as without it.
    virtual void send_file(std::string message) { send(std::move(message)); }
    /// Returns true if such a message has not been read yet.
    virtual bool has_file() const { return false; }
    /// Returns the bytes that the peer has not read, without files.
    virtual std::size_t waiting() const = 0;
    /// Stops reading, and closes when everything is written, or after a second.
    virtual void finish() = 0;
    /// Closes in the same way. `why`, of at most 123 bytes, is for a peer that can be told.
    virtual void turn_out(const char* /*why*/) { finish(); }
};

/// Reason why a connection is given up.
enum class connection_fault {
    too_long, ///< a message beyond message_bytes
    too_slow, ///< no whole message within message_s
    memory,   ///< there is not enough memory for its input
    gone,     ///< the socket failed
};

struct web_reply {
    unsigned status = 200;
    std::string type = "text/plain; charset=utf-8";
    std::string body = {};
    std::string policy = {}; ///< Content-Security-Policy; empty: the page may load nothing
    std::string gzip = {};   ///< the body, compressed, for browsers that take it; empty: there is none
    double after_s = 0.0;    ///< it is sent so late
};

/// Calls of a connection to its server.
struct peer_handlers {
    /// Handles a message: a line without its end, or a text. Returns false to close the connection.
    std::function<bool(std::string_view)> message;
    /// Called once, when the socket is closed. The connection may be forgotten.
    std::function<void()> closed;
    /// Returns true once the first message, which the peer owes, has come. None: any message that is not
    /// empty counts.
    std::function<bool()> met = {};
    /// Handles a message above `large_message`, which comes in parts, and calls `done` later with the result
    /// that `message` would return. Smaller ones are handled in the meantime. Owed where a message may be
    /// that large.
    std::function<void(std::vector<std::string> parts, std::function<void(bool)> done)> large = {};
    /// Lines: the peer sends no more; it may still read.
    std::function<void()> input_ended = {};
    /// Lines: called before the connection closes for any fault but `gone`; send() still works.
    std::function<void(connection_fault)> fault = {};

    /// Browsers: answers GET of a path. `host`: the server's name in the browser; `token`: of "Authorization:
    /// Bearer".
    std::function<web_reply(std::string_view path, std::string_view host, std::string_view token)> get = {};
    /// Browsers: returns true if there is a place for a WebSocket. From then on `message` is called, and
    /// `closed` is its end.
    std::function<bool()> upgrade = {};
};

} // namespace tactor::net
