// SPDX-License-Identifier: MIT
/// \file
/// One peer on a stream socket that sends and is sent lines, within limits. One thread: the context's.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "net/write_budget.hpp"

namespace tactor::net {

struct line_limits {
    std::size_t message_bytes = 1U << 20;
    double message_s = 10.0; ///< for the first message to come, and for each to be complete
    std::size_t waiting_bytes = 4U << 20;
};

/// For timers.
inline std::chrono::steady_clock::duration steady_seconds(double seconds)
{
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(seconds));
}

/// Why a peer is given up.
enum class line_fault {
    too_long, ///< a line beyond message_bytes
    too_slow, ///< a line beyond message_s
    unread,   ///< it does not read what it is sent
    gone,     ///< the socket failed, or everything is said
};

class line_connection : public std::enable_shared_from_this<line_connection> {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    struct handlers {
        /// A line without its end. False: nothing more is read.
        std::function<bool(std::string_view)> line;
        /// The peer sends no more; it may still read.
        std::function<void()> input_ended;
        /// Called before the connection closes; send() still works for `too_long` and `too_slow`.
        std::function<void(line_fault)> fault;
        /// Once, when the socket is closed. The connection may be forgotten.
        std::function<void()> closed;
        /// Whether what came was the first message that is owed; none: any that is not empty is.
        std::function<bool()> met = {};
    };

    line_connection(socket_type s, const line_limits& l, write_budget& all);
    ~line_connection();
    line_connection(const line_connection&) = delete;
    line_connection& operator=(const line_connection&) = delete;

    void start(handlers h);
    /// Queues one line; the end is added. A peer that lets too much wait is dropped.
    void send(std::string line);
    /// Reads nothing more, closes when all is written, or after a second.
    void finish();
    void close();
    /// Bytes that the peer has not taken.
    std::size_t waiting() const noexcept { return share_.waiting(); }

private:
    void read();
    void watch();
    void received(std::size_t n);
    void last_line();
    bool take_lines();
    void arm(double seconds);
    void give_up(line_fault f);
    void give_up_unread();
    void write();
    void wrote(std::size_t n);

    socket_type socket_;
    line_limits limits_;
    write_budget::share share_;
    handlers handlers_;
    boost::asio::steady_timer deadline_;
    boost::asio::steady_timer linger_;
    std::vector<char> chunk_;
    std::string partial_;
    std::deque<std::string> queue_;
    std::size_t in_flight_ = 0; ///< lines
    bool armed_ = false;
    bool met_ = false; ///< the first message has come
    bool reading_ = true;
    bool finishing_ = false;
    bool closed_ = false;
};

} // namespace tactor::net
