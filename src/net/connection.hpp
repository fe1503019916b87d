// SPDX-License-Identifier: MIT
/// \file
/// Connections to peers over stream sockets. A listener accepts connections, incoming messages are handled
/// one by one, and outgoing messages wait in a queue of limited size. Runs in one thread, that of the
/// context.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/owned.hpp"
#include "net/rpc.hpp"

namespace tactor::net {

/// Greatest size of a message that is handled in the thread of the sockets, in bytes. Larger messages are
/// passed to another thread.
constexpr std::size_t large_message = 64U << 10;

/// Outgoing side of a connection to a peer.
class peer {
public:
    peer() = default;
    peer(const peer&) = delete;
    peer& operator=(const peer&) = delete;
    virtual ~peer() = default;

    /// Queues a message. Disconnects the peer if too many bytes are waiting.
    virtual void send(std::string message) = 0;
    /// Queues a notification.
    virtual void notify(std::string_view method, const reply_json& params)
    {
        send(json_line(notification(method, params)));
    }
    /// Queues a message of any size that the peer has requested. It does not count as waiting bytes.
    virtual void send_file(std::string message) { send(std::move(message)); }
    /// Returns the number of queued bytes of messages from send_file().
    virtual std::size_t file_bytes() const { return 0; }
    /// Returns the number of queued bytes, not counting messages from send_file().
    virtual std::size_t queued_bytes() const = 0;
    /// Stops reading. Closes the connection when everything has been written, or after one second.
    virtual void finish() = 0;
    /// Closes the connection as finish() does. `why` is the reason, at most 123 bytes, for protocols that can
    /// transmit a reason.
    virtual void dismiss(const char* /*why*/) { finish(); }
};

/// Reason for closing a faulty connection.
enum class connection_fault {
    too_long, ///< a message longer than message_bytes
    too_slow, ///< no complete message within message_s
    memory,   ///< there is not enough memory for the input
    gone,     ///< the socket failed
};

struct web_reply {
    unsigned status = 200;
    std::string type = "text/plain; charset=utf-8";
    std::string body = {};
    std::string policy = {}; ///< Content-Security-Policy; if empty, the page may load nothing
    std::string gzip = {};   ///< body compressed for browsers that accept gzip, or empty
    double after_s = 0.0;    ///< delay before the reply is sent, s
};

/// Functions of the server that a connection calls.
struct peer_handlers {
    /// Handles a message: a line without its line end, or a text message. Returns false to close the
    /// connection.
    std::function<bool(std::string_view)> message;
    /// Called once when the socket has been closed. The connection may then be destroyed.
    std::function<void()> closed;
    /// Returns true once the required first message has arrived. If this function is not set, any non-empty
    /// message is sufficient.
    std::function<bool()> met = {};
    /// Handles a message longer than `large_message`. Calls `done` later with the result that `message` would
    /// return. Shorter messages are handled in the meantime. Required if messages may be that long.
    std::function<void(std::string text, std::function<void(bool)> done)> large = {};
    /// Lines only: called when the peer has closed its sending side. The peer may still read.
    std::function<void()> input_ended = {};
    /// Lines only: called before the connection closes because of a fault other than `gone`. At this time
    /// send() still works.
    std::function<void(connection_fault)> fault = {};

    /// Browsers: true if a WebSocket need not send a first message.
    bool may_only_read = false;
    /// Browsers only: answers a GET request for a path. `host` is the server's name in the browser. `token`
    /// comes from the header "Authorization: Bearer".
    std::function<web_reply(std::string_view path, std::string_view host, std::string_view token)> get = {};
    /// Browsers only: called when a request names another server, or comes from a page of another server.
    std::function<void(const std::string& why)> refused = {};
    /// Browsers only: returns true if a WebSocket may be opened. After that, `message` is called for each
    /// message of the WebSocket, and `closed` when it ends.
    std::function<bool()> upgrade = {};
};

struct message_limits {
    std::size_t message_bytes = 1U << 20;
    double message_s = 10.0; ///< time until the first message, and for receiving each message
    std::size_t waiting_bytes = 4U << 20;
};

/// Number of bytes to reserve for a message that becomes large. Without this, the text would be copied each
/// time it doubles, and copies for several peers could delay a stop. At most 1 MiB, since the memory may be
/// locked.
constexpr std::size_t bytes_to_reserve(const message_limits& limits)
{
    return std::min(limits.message_bytes, std::size_t{1} << 20) + large_message;
}

/// Converts seconds to the duration type of timers.
inline std::chrono::steady_clock::duration to_steady_duration(double seconds)
{
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(seconds));
}

/// Base class of the connections for lines and for browsers. Each derived class reads from a socket and
/// writes to it.
class connection : public peer, public std::enable_shared_from_this<connection> {
public:
    connection(const boost::asio::any_io_executor& executor, const message_limits& l);

    /// Begins to read.
    void start(peer_handlers h);
    void send(std::string message) override { queue(std::move(message), false); }
    void send_file(std::string message) override { queue(std::move(message), true); }
    std::size_t file_bytes() const override { return file_bytes_; }
    std::size_t queued_bytes() const override { return waiting_; }
    void finish() override;

protected:
    struct outgoing {
        std::string text;
        bool file = false;
    };

    /// Begins to read.
    virtual void begin_reading() { read(); }
    /// Reads until a message is complete. Its last action is to call handle().
    virtual void read() = 0;
    /// Writes the first messages of queued(), and calls on_written().
    virtual void write() = 0;
    /// Closes the connection with the closing handshake of its protocol. Called when everything has been
    /// written.
    virtual void close_with_handshake() { close(); }
    /// Closes the socket.
    virtual void close_socket() = 0;
    /// Closes the connection with a fault. Called when no message was complete in time.
    virtual void time_out() { fail(connection_fault::too_slow); }

    /// Handles a message, then continues reading.
    void handle(std::string_view text);
    /// Passes a large message to peer_handlers::large, then continues reading.
    void handle_large_message(std::string text);
    /// Records that a part of a message has arrived.
    void begin_message();
    /// Notes that a message is complete.
    void end_message();
    /// Removes messages of queued() that have been written, and continues writing.
    void on_written(std::size_t messages);
    /// Writes the next messages. If no message is left and finish() has been called, closes the connection.
    void continue_writing();
    /// Sends the peer a description of the fault, and closes the connection.
    void fail(connection_fault f);
    void close();
    /// Starts a timer that closes the connection after one second.
    void start_close_timer();
    void stop_reading();
    void arm(double seconds);
    void disarm();
    /// Calls `f`. If there is not enough memory for the input, closes this connection, but no other
    /// connection.
    template <typename F>
    void catch_bad_alloc(F f)
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
    bool is_finishing() const noexcept { return finishing_; }
    bool reads() const noexcept { return reading_ && !closed_; }
    /// Sets whether messages are written now or stay in the queue.
    void allow_writing(bool may) noexcept { may_write_ = may; }

private:
    bool handled(bool go_on);
    void queue(std::string message, bool file);

    message_limits limits_;
    peer_handlers handlers_;
    boost::asio::steady_timer deadline_;
    boost::asio::steady_timer linger_;
    std::deque<outgoing> queue_;
    std::size_t waiting_ = 0; ///< bytes in the queue, without those of send_file()
    std::size_t file_bytes_ = 0;
    unsigned large_ = 0; ///< number of large messages that other code is still handling
    bool armed_ = false;
    bool met_ = false; ///< true once the first message has arrived
    bool may_write_ = true;
    bool writing_ = false;
    bool reading_ = true;
    bool finishing_ = false;
    bool closed_ = false;
};

/// Connection to a peer that exchanges lines with the server.
class line_connection final : public connection {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    line_connection(socket_type s, const message_limits& l);

private:
    void read() override;
    void write() override;
    void close_socket() override;
    void next_line();
    void read_more();

    socket_type socket_;
    std::vector<char> chunk_;
    std::string text_;        ///< lines that have not been handled, and the beginning of the next
    std::size_t begin_ = 0;   ///< offset of the next line in text_
    std::size_t scanned_ = 0; ///< there is no line end between begin_ and this offset
    bool over_ = false;       ///< true if the peer has closed its sending side
};

/// A listening socket that accepts connections one after the other. If no descriptor is free, it accepts a
/// client on a spare descriptor, sends a refusal and closes this connection.
class listener {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    /// Listens on `fd`, which the caller keeps open. If no descriptor is free, sends `when_full` to the
    /// client and calls `turned_away`.
    listener(boost::asio::io_context& io, int fd, std::string when_full,
             std::function<void(socket_type)> taken, std::function<void()> turned_away = {});
    ~listener();
    listener(const listener&) = delete;
    listener& operator=(const listener&) = delete;

    void start();
    void stop();

private:
    void take();
    bool reject_client() noexcept;
    void reserve_descriptor() noexcept;

    boost::asio::io_context& io_;
    boost::asio::posix::stream_descriptor fd_;
    boost::asio::steady_timer pause_;
    std::string when_full_;
    std::function<void(socket_type)> taken_;
    std::function<void()> turned_away_;
    detail::owned_fd spare_;
};

} // namespace tactor::net
