// SPDX-License-Identifier: MIT
/// \file
/// A peer's connection: messages come in one by one, others wait in a bounded queue to be written. One
/// thread: the context's.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "net/peer.hpp"

namespace tactor::net {

struct message_limits {
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

/// The common part of connections of lines and of browsers. Each of them reads and writes a socket.
class connection : public peer, public std::enable_shared_from_this<connection> {
public:
    connection(const boost::asio::any_io_executor& executor, const message_limits& l);

    /// Begins to read.
    void start(peer_handlers h);
    void send(std::string message) override { queue(std::move(message), false); }
    void send_file(std::string message) override { queue(std::move(message), true); }
    bool has_file() const override { return files_ != 0; }
    std::size_t waiting() const override { return waiting_; }
    void finish() override;

protected:
    struct outgoing {
        std::string text;
        bool file = false;
    };

    /// Begins to read.
    virtual void read_first() { read(); }
    /// Reads until there is a message, and calls handle() as the last thing.
    virtual void read() = 0;
    /// Writes the first messages of queued(), and calls wrote().
    virtual void write() = 0;
    /// Closes in order. Everything is written.
    virtual void say_farewell() { close(); }
    /// Closes the socket.
    virtual void shut() = 0;
    /// Called when no message was complete in time.
    virtual void time_out() { fail(connection_fault::too_slow); }

    /// Handles a message, and reads on.
    void handle(std::string_view text);
    /// Gives a large one away, and reads on.
    void handle_large(std::vector<std::string> parts);
    /// Notes that a part of a message has come.
    void message_begins();
    /// Notes that a message is complete.
    void message_ends();
    /// Notes that the first messages of queued() were written, and writes on.
    void wrote(std::size_t messages);
    /// Writes what waits, or says farewell.
    void write_on();
    /// Tells the peer and closes.
    void fail(connection_fault f);
    void close();
    /// Closes after a second at most.
    void hang_up_soon();
    void stop_reading();
    void arm(double seconds);
    void disarm();
    /// Calls `f`. Closes this connection if its input needs more memory than there is; the others stay.
    template <typename F>
    void within_memory(F f)
    {
        const auto self = shared_from_this();
        try {
            f();
        } catch (const std::bad_alloc&) {
            fail(connection_fault::memory);
        }
    }

    const std::deque<outgoing>& queued() const noexcept { return queue_; }
    const message_limits& limits() const noexcept { return limits_; }
    peer_handlers& calls() noexcept { return handlers_; }
    boost::asio::any_io_executor executor() { return deadline_.get_executor(); }
    bool closed() const noexcept { return closed_; }
    bool finishing() const noexcept { return finishing_; }
    bool reads() const noexcept { return reading_ && !closed_; }
    /// Lets messages wait, or be written.
    void may_write(bool may) noexcept { may_write_ = may; }

private:
    bool handled(bool go_on);
    void queue(std::string message, bool file);

    message_limits limits_;
    peer_handlers handlers_;
    boost::asio::steady_timer deadline_;
    boost::asio::steady_timer linger_;
    std::deque<outgoing> queue_;
    std::size_t waiting_ = 0; ///< bytes in the queue, without files
    std::size_t files_ = 0;
    unsigned large_ = 0; ///< messages that were given away
    bool armed_ = false;
    bool met_ = false; ///< the first message has come
    bool may_write_ = true;
    bool writing_ = false;
    bool reading_ = true;
    bool finishing_ = false;
    bool closed_ = false;
};

} // namespace tactor::net
