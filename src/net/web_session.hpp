// SPDX-License-Identifier: MIT
/// \file
/// Contents of a browser's connection: the request (web_request.cpp), then, if requested, the WebSocket
/// (web_connection.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/compose.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include "net/web_connection.hpp"
#include "net/web_frames.hpp"

namespace tactor::net {

/// The part of an Asio stream that Beast's WebSocket needs.
class watched_socket {
public:
    using next_layer_type = boost::asio::ip::tcp::socket;
    using executor_type = next_layer_type::executor_type;
    using sight = std::function<void(std::span<const std::byte>)>;
    using test = std::function<bool()>;

    /// Wraps a socket, which must outlive it. `seen` gets the bytes before the reader does. `bad_reason`
    /// returns true if the peer's close frame has a reason that is not UTF-8.
    watched_socket(next_layer_type& s, sight seen, test bad_reason)
        : socket_(s), seen_(std::move(seen)), bad_reason_(std::move(bad_reason))
    {
    }

    executor_type get_executor() noexcept { return socket_.get_executor(); }
    next_layer_type& next_layer() noexcept { return socket_; }
    const next_layer_type& next_layer() const noexcept { return socket_; }

    template <class Buffers, class Token>
    auto async_read_some(const Buffers& into, Token&& token)
    {
        return boost::asio::async_compose<Token, void(boost::system::error_code, std::size_t)>(
            [this, into, asked = false](auto& self, const boost::system::error_code& e = {},
                                        std::size_t n = 0) mutable {
                if (!std::exchange(asked, true))
                    return socket_.async_read_some(into, std::move(self));
                see(into, n);
                self.complete(e, n);
            },
            token, socket_);
    }
    template <class Buffers, class Token>
    auto async_write_some(const Buffers& from, Token&& token)
    {
        if (is_protocol_error(from) && bad_reason_())
            return socket_.async_write_some(boost::asio::buffer(bad_payload), std::forward<Token>(token));
        return socket_.async_write_some(from, std::forward<Token>(token));
    }

private:
    // Close frames, unmasked. Beast (1.74 to 1.83) answers a reason that is not UTF-8 with 1002; RFC 6455,
    // section 8.1, requires 1007.
    static constexpr std::array<unsigned char, 4> protocol_error{0x88, 2, 0x03, 0xea};
    static constexpr std::array<unsigned char, 4> bad_payload{0x88, 2, 0x03, 0xef};

    template <class Buffers>
    static bool is_protocol_error(const Buffers& from)
    {
        std::array<unsigned char, protocol_error.size() + 1> begin{};
        return boost::asio::buffer_copy(boost::asio::buffer(begin), from) == protocol_error.size() &&
               std::equal(protocol_error.begin(), protocol_error.end(), begin.begin());
    }

    template <class Buffers>
    void see(const Buffers& into, std::size_t n)
    {
        const auto end = boost::asio::buffer_sequence_end(into);
        for (auto b = boost::asio::buffer_sequence_begin(into); b != end && n > 0; ++b) {
            const boost::asio::mutable_buffer one(*b);
            const std::size_t here = std::min(n, one.size());
            seen_({static_cast<const std::byte*>(one.data()), here});
            n -= here;
        }
    }

    next_layer_type& socket_;
    sight seen_;
    test bad_reason_;
};

template <class Handler>
void async_teardown(boost::beast::role_type role, watched_socket& s, Handler&& handler)
{
    using boost::beast::websocket::async_teardown;
    async_teardown(role, s.next_layer(), std::forward<Handler>(handler));
}

struct web_session final : web_connection, std::enable_shared_from_this<web_session> {
    using socket_type = boost::asio::ip::tcp::socket;

    web_session(socket_type s, const line_limits& l, shared_by_peers& all, std::vector<std::string> hosts);

    void start(peer_handlers h) override;
    void send(std::string text) override { enqueue(std::move(text), false); }
    void send_large(std::string text) override { enqueue(std::move(text), true); }
    std::size_t waiting() const override { return unread.held(); }
    std::size_t room() const override { return unread.room(); }
    void finish() override;
    /// Closes with status 1008.
    void turn_out(const char* reason) override;

    // Request.
    void read_request();
    void answer_request();
    void respond(web_reply r);
    void send_response();
    void upgrade();
    // WebSocket.
    void read();
    void received();
    void handle_large(std::string text);
    void handled(bool empty, bool go_on);
    void enqueue(std::string text, bool large);
    void write();
    void give_up();
    void give_up_crowded();
    template <typename F>
    void within_memory(F f);
    void finish(const boost::beast::websocket::close_reason& r);
    void hang_up_soon();
    void watch();
    // Both.
    void arm(double seconds);
    void disarm();
    void close();

    line_limits limits;
    byte_budget::share unread;
    byte_budget::share unfinished;
    message_turns& turns;
    short_turns& small;
    std::vector<std::string> allowed;
    std::string local;
    peer_handlers calls;
    socket_type socket;
    std::optional<boost::beast::websocket::stream<watched_socket>> ws;
    web_frames frames;
    std::uint64_t waited_for = 0; ///< while `armed` and `met`: number of that message
    boost::beast::flat_buffer buffer;
    boost::beast::http::request_parser<boost::beast::http::empty_body> parser;
    boost::beast::http::response<boost::beast::http::string_body> response;
    boost::asio::steady_timer deadline;
    boost::asio::steady_timer lingering;
    std::deque<queued_text> queue;
    std::size_t large_bytes = 0; ///< of large messages in the queue
    boost::beast::websocket::close_reason why{boost::beast::websocket::close_code::normal};
    bool armed = false;
    bool met = false; ///< the first message has come
    bool accepted = false;
    bool answered = false; ///< with a page or a refusal
    bool writing = false;
    bool reading = true;
    bool finishing = false;
    bool closing = false;
    bool closed = false;
};

} // namespace tactor::net
