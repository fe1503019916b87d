// SPDX-License-Identifier: MIT
/// \file
/// A peer on a stream socket that exchanges lines with the server, within limits. One thread: the context's.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "net/shared_by_peers.hpp"

namespace tactor::net {

struct line_limits {
    std::size_t message_bytes = 1U << 20;
    double message_s = 10.0; ///< for the first message, and for each message to be complete
    std::size_t waiting_bytes = 4U << 20;
};

/// Converts seconds for timers.
inline std::chrono::steady_clock::duration steady_seconds(double seconds)
{
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(seconds));
}

/// Bytes of a message that is handled at once. A larger one waits for its turn.
constexpr std::size_t small_message = 2048;

class line_connection final : public peer, public std::enable_shared_from_this<line_connection> {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    line_connection(socket_type s, const line_limits& l, shared_by_peers& all);

    void start(peer_handlers h);
    void send(std::string line) override { queue(std::move(line), false); }
    void send_large(std::string line) override { queue(std::move(line), true); }
    void finish() override;
    std::size_t waiting() const override { return unread_.held(); }
    std::size_t room() const override { return unread_.room(); }
    void close();

private:
    void read();
    void watch();
    void received(std::size_t n);
    void next_line();
    bool is_urgent(std::size_t size) const;
    void handle_line(std::size_t size);
    void handle_large(std::size_t size);
    void handled(std::size_t size, bool go_on);
    std::string whole_line(std::size_t size);
    bool hold();
    void drop_unfinished();
    void no_line();
    void all_read();
    void arm(double seconds);
    void give_up(line_fault f);
    void give_up_soon(line_fault f);
    template <typename F>
    void within_memory(F f);
    void queue(std::string line, bool large);
    void write();
    void wrote(std::size_t n);

    socket_type socket_;
    line_limits limits_;
    byte_budget::share unread_;
    byte_budget::share unfinished_;
    message_turns& turns_;
    short_turns& small_;
    peer_handlers handlers_;
    boost::asio::steady_timer deadline_;
    boost::asio::steady_timer linger_;
    std::vector<char> chunk_;
    std::vector<std::string> blocks_; ///< the start of a line that is longer than a block
    std::string partial_;             ///< the rest of it, or short lines
    std::size_t begin_ = 0;           ///< start of the next line in it
    std::size_t scanned_ = 0;         ///< no line ends between begin_ and this place
    std::deque<queued_text> queue_;
    std::size_t large_bytes_ = 0; ///< of large messages in the queue
    std::size_t in_flight_ = 0;   ///< lines
    bool armed_ = false;
    bool met_ = false; ///< the first message has come
    bool reading_ = true;
    bool over_ = false; ///< the peer sends no more
    bool finishing_ = false;
    bool closed_ = false;
};

} // namespace tactor::net
