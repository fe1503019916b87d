// SPDX-License-Identifier: MIT
/// \file
/// Peers of a server, and the memory and turns that they share. One thread: the context's.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio/io_context.hpp>

namespace tactor::net {

/// The way to a peer, over a connection of any kind.
class peer {
public:
    peer() = default;
    peer(const peer&) = delete;
    peer& operator=(const peer&) = delete;
    virtual ~peer() = default;

    /// Queues a message. Drops a peer that lets too much wait.
    virtual void send(std::string message) = 0;
    /// Queues a large message that the peer asked for. Beside it as much may wait as without it.
    virtual void send_large(std::string message) { send(std::move(message)); }
    /// Returns the bytes that all peers together may still let wait.
    virtual std::size_t room() const { return std::numeric_limits<std::size_t>::max(); }
    /// Returns the bytes that the peer has not read.
    virtual std::size_t waiting() const = 0;
    /// Stops reading, and closes when everything is written, or after a second.
    virtual void finish() = 0;
    /// Closes in the same way. `why`, of at most 123 bytes, is for a peer that can be told.
    virtual void turn_out(const char* /*why*/) { finish(); }
};

/// A message that waits to be written.
struct queued_text {
    std::string text;
    bool large = false; ///< the peer asked for it, whatever its size
};

/// Reason why a connection is given up.
enum class line_fault {
    too_long, ///< a line beyond message_bytes
    too_slow, ///< no whole message within message_s
    crowded,  ///< unfinished messages of all peers are too many, and this one has most
    unread,   ///< it does not read its messages
    memory,   ///< there is not enough memory for its input
    gone,     ///< the socket failed, or everything is written
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
    /// Handles a message above `small_message`, on its turn. The next one is handled when `done` is called
    /// with the result that `message` would return. None: `message` handles all.
    std::function<void(std::string text, std::function<void(bool)> done)> large = {};
    /// Returns true for a small message that is handled at once, before those of others. None: no message is
    /// urgent.
    std::function<bool(std::string_view)> urgent = {};

    /// Lines: the peer sends no more; it may still read.
    std::function<void()> input_ended = {};
    /// Lines: called before the connection closes; send() still works for all faults but `unread` and `gone`.
    std::function<void(line_fault)> fault = {};

    /// Browsers: answers GET of a path. `host`: the server's name in the browser; `token`: of "Authorization:
    /// Bearer".
    std::function<web_reply(std::string_view path, std::string_view host, std::string_view token)> get = {};
    /// Browsers: returns true if there is a place for a WebSocket. From then on `message` is called, and
    /// `closed` is its end.
    std::function<bool()> upgrade = {};
};

/// Limit on the bytes that all peers hold together. Beyond it the peer that holds most is given up, not the
/// one that comes next.
class byte_budget {
public:
    explicit byte_budget(std::size_t most) : all_(std::make_shared<sum>()) { all_->most = most; }

    class share;
    std::size_t held() const noexcept { return all_->held; }

private:
    struct sum {
        std::size_t most = 0;
        std::size_t held = 0;
        std::set<share*> shares = {}; ///< of peers that were not given up
    };
    std::shared_ptr<sum> all_; ///< connections outlive their server until its context ends
};

/// Part of one peer in the budget.
class byte_budget::share {
public:
    /// Makes a share. `give_up` is called at most once, from within the add() of any peer, so it must not end
    /// a share.
    share(const byte_budget& all, std::function<void()> give_up);
    ~share();
    share(const share&) = delete;
    share& operator=(const share&) = delete;

    /// Adds bytes. Returns false if this peer was given up instead.
    bool add(std::size_t n);
    /// Returns bytes to the budget.
    void take(std::size_t n) noexcept;
    /// Sets the held bytes. Returns false if this peer was given up instead.
    bool hold(std::size_t n);
    /// Stops counting the bytes of this peer.
    void give_up();
    std::size_t held() const noexcept { return held_; }
    /// Returns the bytes that all peers together may still add.
    std::size_t room() const noexcept { return all_->most - all_->held; }

private:
    void leave() noexcept;

    std::shared_ptr<sum> all_;
    std::function<void()> give_up_;
    std::size_t held_ = 0;
};

/// Turns of large messages: one is read at a time, so that small ones of other peers can pass.
class message_turns {
public:
    explicit message_turns(boost::asio::io_context& io) : io_(io) {}

    /// Calls `on_turn` later, when all earlier ones have passed.
    void join(std::function<void()> on_turn);
    /// Ends a turn.
    void pass();

private:
    void next();

    boost::asio::io_context& io_;
    std::deque<std::function<void()>> waiting_;
    bool busy_ = false;
};

/// Turns of small messages: a few at a time, then Asio looks at the sockets again. So an urgent message waits
/// for no more than these, however many peers have messages.
class short_turns {
public:
    explicit short_turns(boost::asio::io_context& io) : io_(io) {}

    /// Calls `on_turn` later, after all earlier ones.
    void join(std::function<void()> on_turn);

private:
    void run();

    boost::asio::io_context& io_;
    std::deque<std::function<void()>> waiting_;
    bool posted_ = false;
};

struct shared_by_peers {
    explicit shared_by_peers(boost::asio::io_context& io, std::size_t most_unread = 64U << 20,
                             std::size_t most_unfinished = 32U << 20)
        : unread(most_unread), unfinished(most_unfinished), turns(io), small(io)
    {
    }

    byte_budget unread;     ///< answers that peers have not read
    byte_budget unfinished; ///< messages that are incomplete, or wait for their turn
    message_turns turns;    ///< of large ones
    short_turns small;
};

} // namespace tactor::net
