// SPDX-License-Identifier: MIT
/// \file
/// Connections of peers on stream sockets: a listener accepts them, incoming messages are handled one by one,
/// and outgoing messages wait in a bounded queue. One thread: the context's.
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

/// Most bytes of a message that is handled in the thread of the sockets. Larger ones are handed over.
constexpr std::size_t large_message = 64U << 10;

/// Outgoing side of a connection to a peer.
class peer {
public:
    peer() = default;
    peer(const peer&) = delete;
    peer& operator=(const peer&) = delete;
    virtual ~peer() = default;

    /// Queues a message. Drops the peer if too many bytes wait.
    virtual void send(std::string message) = 0;
    /// Queues a notification.
    virtual void notify(std::string_view method, const reply_json& params)
    {
        send(json_line(notification(method, params)));
    }
    /// Queues a message of any size that the peer requested. It does not count towards the bytes that may
    /// wait.
    virtual void send_file(std::string message) { send(std::move(message)); }
    /// Returns true if such a message is still queued.
    virtual bool has_file() const { return false; }
    /// Returns the number of queued bytes, without files.
    virtual std::size_t waiting() const = 0;
    /// Stops reading, and closes when everything is written, or after a second.
    virtual void finish() = 0;
    /// Closes in the same way. `why`: reason, at most 123 bytes, for peers whose protocol carries one.
    virtual void dismiss(const char* /*why*/) { finish(); }
};

/// Reason for which a connection is given up.
enum class connection_fault {
    too_long, ///< a message beyond message_bytes
    too_slow, ///< no complete message within message_s
    memory,   ///< there is not enough memory for its input
    gone,     ///< the socket failed
};

struct web_reply {
    unsigned status = 200;
    std::string type = "text/plain; charset=utf-8";
    std::string body = {};
    std::string policy = {}; ///< Content-Security-Policy; empty: the page may load nothing
    std::string gzip = {};   ///< compressed body, for browsers that accept it; empty: none
    double after_s = 0.0;    ///< delay before it is sent, s
};

/// Calls of a connection to its server.
struct peer_handlers {
    /// Handles a message: a line without its end, or a text. Returns false to close the connection.
    std::function<bool(std::string_view)> message;
    /// Called once, when the socket is closed. The connection may be forgotten.
    std::function<void()> closed;
    /// Returns true once the required first message has come. Without this function any message that is not
    /// empty counts.
    std::function<bool()> met = {};
    /// Handles a message above `large_message`, and calls `done` later with the result that `message` would
    /// return. Smaller messages are handled in the meantime. Required if messages may be that large.
    std::function<void(std::string text, std::function<void(bool)> done)> large = {};
    /// Lines: called when the peer sends no more; it may still read.
    std::function<void()> input_ended = {};
    /// Lines: called before the connection closes for any fault but `gone`; send() still works.
    std::function<void(connection_fault)> fault = {};

    /// Browsers: true if a WebSocket need not send a first message.
    bool may_only_read = false;
    /// Browsers: answers GET of a path. `host`: the server's name in the browser; `token`: of "Authorization:
    /// Bearer".
    std::function<web_reply(std::string_view path, std::string_view host, std::string_view token)> get = {};
    /// Browsers: called when a request names another server or comes from another server's page.
    std::function<void(const std::string& why)> refused = {};
    /// Browsers: returns true if a WebSocket may be opened. After that, `message` is called for its messages,
    /// and `closed` at its end.
    std::function<bool()> upgrade = {};
};

struct message_limits {
    std::size_t message_bytes = 1U << 20;
    double message_s = 10.0; ///< time for the first message to come, and for each message to be complete
    std::size_t waiting_bytes = 4U << 20;
};

/// Bytes to reserve for a message that is becoming large: text that grows by doubling is copied each time,
/// and the copies for all peers, made in one turn, would delay a stop. At most 1 MiB, which may be locked
/// memory.
constexpr std::size_t room_for(const message_limits& limits)
{
    return std::min(limits.message_bytes, std::size_t{1} << 20) + large_message;
}

/// Converts seconds for timers.
inline std::chrono::steady_clock::duration steady_seconds(double seconds)
{
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(seconds));
}

/// Common part of the connections of lines and of browsers. Each derived class reads and writes a socket.
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
    /// Reads until there is a message, then calls handle() as its last act.
    virtual void read() = 0;
    /// Writes the first messages of queued(), and calls wrote().
    virtual void write() = 0;
    /// Closes in order. Called when everything has been written.
    virtual void say_farewell() { close(); }
    /// Closes the socket.
    virtual void shut() = 0;
    /// Fails the connection. Called when no message was complete in time.
    virtual void time_out() { fail(connection_fault::too_slow); }

    /// Handles a message, then continues reading.
    void handle(std::string_view text);
    /// Hands over a large message, then continues reading.
    void handle_large(std::string text);
    /// Notes that a part of a message has come.
    void message_begins();
    /// Notes that a message is complete.
    void message_ends();
    /// Notes that the first messages of queued() were written, and continues writing.
    void wrote(std::size_t messages);
    /// Continues writing; if nothing waits, closes in order.
    void write_on();
    /// Tells the peer the fault and closes.
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
    /// Sets whether messages are written, or wait.
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
    unsigned large_ = 0; ///< number of large messages that were handed over
    bool armed_ = false;
    bool met_ = false; ///< the first message has come
    bool may_write_ = true;
    bool writing_ = false;
    bool reading_ = true;
    bool finishing_ = false;
    bool closed_ = false;
};

/// Connection of a peer that exchanges lines with the server.
class line_connection final : public connection {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    line_connection(socket_type s, const message_limits& l);

private:
    void read() override;
    void write() override;
    void shut() override;
    void next_line();
    void read_more();

    socket_type socket_;
    std::vector<char> chunk_;
    std::string text_;        ///< lines that have not been handled, and the start of one
    std::size_t begin_ = 0;   ///< start of the next line in it
    std::size_t scanned_ = 0; ///< no line ends between begin_ and this place
    bool over_ = false;       ///< the peer sends no more
};

/// A listening socket that accepts one connection after another. Without a free descriptor it accepts a
/// client on a spare one, sends a refusal and closes.
class listener {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    /// Listens on `fd`, which the caller keeps. `when_full`: refusal when descriptors run out; `turned_away`
    /// is called after it.
    listener(boost::asio::io_context& io, int fd, std::string when_full,
             std::function<void(socket_type)> taken, std::function<void()> turned_away = {});
    ~listener();
    listener(const listener&) = delete;
    listener& operator=(const listener&) = delete;

    void start();
    void stop();

private:
    void take();
    bool turn_away() noexcept;
    void keep_spare() noexcept;

    boost::asio::io_context& io_;
    boost::asio::posix::stream_descriptor fd_;
    boost::asio::steady_timer pause_;
    std::string when_full_;
    std::function<void(socket_type)> taken_;
    std::function<void()> turned_away_;
    detail::owned_fd spare_;
};

} // namespace tactor::net
