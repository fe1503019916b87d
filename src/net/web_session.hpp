// SPDX-License-Identifier: MIT
/// \file
/// What a browser's connection consists of: the request (web_request.cpp), then, where it asks for one, the
/// WebSocket (web_connection.cpp).
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "net/watched_socket.hpp"
#include "net/web_connection.hpp"
#include "net/web_frames.hpp"

namespace tactor::net {

struct web_connection::session : std::enable_shared_from_this<session> {
    session(socket_type s, const line_limits& l, shared_by_peers& all, std::vector<std::string> hosts);
    ~session() = default;
    session(const session&) = delete;
    session& operator=(const session&) = delete;

    // The request.
    void read_request();
    void answer_request();
    void respond(web_reply r);
    void upgrade();
    // The WebSocket.
    void read();
    void received();
    void handle_large(std::string text);
    void handled(bool empty, bool go_on);
    void send(std::string text);
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
    handlers calls;
    socket_type socket;
    std::optional<boost::beast::websocket::stream<watched_socket>> ws;
    web_frames frames;
    std::uint64_t waited_for = 0; ///< while `armed` and `met`: the number of that message
    boost::beast::flat_buffer buffer;
    boost::beast::http::request_parser<boost::beast::http::empty_body> parser;
    boost::beast::http::response<boost::beast::http::string_body> response;
    boost::asio::steady_timer deadline;
    boost::asio::steady_timer lingering;
    std::deque<std::string> queue;
    boost::beast::websocket::close_reason why{boost::beast::websocket::close_code::normal};
    bool armed = false;
    bool met = false; ///< the first message has come
    bool accepted = false;
    bool answered = false; ///< with a page, or why there is none
    bool writing = false;
    bool reading = true;
    bool finishing = false;
    bool closing = false;
    bool closed = false;
};

} // namespace tactor::net
