// SPDX-License-Identifier: MIT
/// \file
/// Memory and turns that all peers of a server share. One thread: the context's.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <set>

#include <boost/asio/io_context.hpp>

namespace tactor::net {

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
