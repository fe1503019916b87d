// SPDX-License-Identifier: MIT
#include "net/web_connection.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "net/listen.hpp"
#include "net/watched_socket.hpp"
#include "net/web_access.hpp"
#include "net/web_frames.hpp"

namespace tactor::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr std::size_t most_header_bytes = 8U << 10;
constexpr std::chrono::seconds to_hang_up{1};

std::string_view view(boost::string_view s)
{
    return {s.data(), s.size()};
}

} // namespace

struct web_connection::session : std::enable_shared_from_this<session> {
    session(socket_type s, const line_limits& l, write_budget& budget, std::vector<std::string> hosts)
        : limits(l),
          share(budget, [this] { give_up(); }),
          allowed(std::move(hosts)),
          local(local_address(s.native_handle())),
          socket(std::move(s)),
          deadline(socket.get_executor()),
          lingering(socket.get_executor())
    {
        parser.header_limit(most_header_bytes);
        parser.body_limit(std::numeric_limits<std::uint64_t>::max()); // none is read
    }
    ~session() = default;
    session(const session&) = delete;
    session& operator=(const session&) = delete;

    void read_request();
    void answer_request();
    void respond(web_reply r);
    void upgrade();
    void read();
    void received();
    void send(std::string text);
    void write();
    void give_up();
    void finish(const websocket::close_reason& r);
    void hang_up_soon();
    void watch();
    void arm(double seconds);
    void disarm();
    void close();

    line_limits limits;
    write_budget::share share;
    std::vector<std::string> allowed;
    std::string local;
    handlers calls;
    socket_type socket;
    std::optional<websocket::stream<watched_socket>> ws;
    web_frames frames;
    std::uint64_t waited_for = 0; ///< while `armed` and `met`: the number of that message
    beast::flat_buffer buffer;
    http::request_parser<http::empty_body> parser;
    http::response<http::string_body> response;
    asio::steady_timer deadline;
    asio::steady_timer lingering;
    std::deque<std::string> queue;
    websocket::close_reason why{websocket::close_code::normal};
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

void web_connection::session::read_request()
{
    arm(limits.message_s);
    http::async_read_header(
        socket, buffer, parser, [self = shared_from_this()](const beast::error_code& e, std::size_t) {
            if (self->closed || self->answered)
                return;
            self->disarm();
            if (e == http::error::header_limit)
                self->respond({413, "text/plain", "too much\n", ""});
            else if (e && e.category() == make_error_code(http::error::bad_target).category() &&
                     e != http::error::end_of_stream && e != http::error::partial_message)
                self->respond({400, "text/plain", "no request of HTTP\n", ""});
            else if (e)
                self->close();
            else
                self->answer_request();
        });
}

void web_connection::session::answer_request()
{
    const auto& request = parser.get();
    const std::string said(view(request[http::field::host]));
    const web_target to = target_of(view(request.target()), said);
    const auto origins = request.equal_range(http::field::origin);
    const bool one_host = request.count(http::field::host) == 1;
    bool ours = one_host && host_is_ours(said, local, allowed) && host_is_ours(to.host, local, allowed);
    for (auto o = origins.first; o != origins.second; ++o)
        ours = ours && origin_is_ours(view(o->value()), to.host, allowed);
    if (!ours)
        return respond({403, "text/plain", "another name or another page than this server's\n", ""});
    if (request.method() != http::verb::get)
        return respond({405, "text/plain", "GET only\n", ""});
    if (parser.chunked() || parser.content_length().value_or(0) > 0)
        return respond({413, "text/plain", "too much\n", ""});
    if (to.path == "/rpc" && websocket::is_upgrade(request))
        return upgrade();
    if (to.path == "/rpc")
        return respond({426, "text/plain", "a WebSocket\n", ""});
    respond(calls.get(to.path, to.host, bearer_of(view(request[http::field::authorization]))));
}

// One request a connection: a page asks for little.
void web_connection::session::respond(web_reply r)
{
    answered = true;
    response.result(r.status);
    response.version(11);
    response.set(http::field::server, "tactor");
    response.set(http::field::content_type, r.type);
    response.set(http::field::cache_control, "no-store");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Content-Security-Policy",
                 r.policy.empty() ? "default-src 'none'; frame-ancestors 'none'" : r.policy);
    if (r.status == 405)
        response.set(http::field::allow, "GET");
    if (r.status == 426) {
        response.set(http::field::upgrade, "websocket");
        response.set(http::field::connection, "upgrade, close");
    }
    response.body() = std::move(r.body);
    if (r.status != 426)
        response.keep_alive(false);
    response.prepare_payload();
    if (parser.get().method() == http::verb::head)
        response.body().clear(); // how long it would be is said
    arm(limits.message_s);
    http::async_write(socket, response,
                      [self = shared_from_this()](const beast::error_code&, std::size_t) { self->close(); });
}

void web_connection::session::upgrade()
{
    if (!calls.upgrade())
        return respond({503, "text/plain", "there is no place, try again later\n", ""});
    accepted = true;
    ws.emplace(socket, [this](std::span<const std::byte> bytes) {
        frames.take(bytes);
        watch();
    });
    websocket::stream_base::timeout t{};
    t.handshake_timeout = steady_seconds(limits.message_s);
    // A browser that is gone without a word is found by pings.
    t.idle_timeout = std::chrono::seconds(60);
    t.keep_alive_pings = true;
    ws->set_option(t);
    ws->read_message_max(limits.message_bytes);
    ws->auto_fragment(false);
    ws->set_option(websocket::stream_base::decorator(
        [](websocket::response_type& r) { r.set(http::field::server, "tactor"); }));
    // Whoever says goodbye has a second to hang up.
    ws->control_callback([this](websocket::frame_type kind, boost::string_view) {
        if (kind == websocket::frame_type::close)
            hang_up_soon();
    });
    ws->async_accept(parser.get(), [self = shared_from_this()](const beast::error_code& e) {
        if (self->closed)
            return;
        if (e)
            return self->close();
        self->buffer.consume(self->buffer.size());
        self->arm(self->limits.message_s);
        self->read();
        if (!self->queue.empty())
            self->write();
        else if (self->finishing)
            self->finish(self->why);
    });
}

void web_connection::session::read()
{
    if (!reading || closed)
        return;
    ws->async_read_some(buffer, 16U << 10,
                        [self = shared_from_this()](const beast::error_code& e, std::size_t) {
                            if (self->closed)
                                return;
                            if (e)
                                return self->close(); // Beast has said why, where somebody is there
                            self->received();
                        });
}

void web_connection::session::received()
{
    if (!ws->is_message_done())
        return read();
    const std::string text(static_cast<const char*>(buffer.data().data()), buffer.size());
    buffer.consume(buffer.size());
    if (!ws->got_text())
        return finish({websocket::close_code::unknown_data, "text is taken"});
    if (!text.empty() && !calls.text(text))
        return finish({websocket::close_code::policy_error, "this is not taken"});
    if (!met && !text.empty() && (!calls.met || calls.met())) {
        met = true;
        disarm();
        watch();
    }
    read();
}

// Beast tells of payload only: not of a head alone, nor of a fragment without any.
void web_connection::session::watch()
{
    if (!met || closed || finishing)
        return;
    if (!frames.open())
        return disarm();
    if (armed && waited_for == frames.whole())
        return;
    waited_for = frames.whole();
    arm(limits.message_s);
}

void web_connection::session::disarm()
{
    if (std::exchange(armed, false))
        deadline.cancel();
}

void web_connection::session::send(std::string text)
{
    if (closed || finishing || !accepted)
        return;
    const std::size_t n = text.size();
    if (share.waiting() + n > limits.waiting_bytes)
        share.give_up();
    if (!share.add(n))
        return;
    queue.push_back(std::move(text));
    if (!writing && ws && ws->is_open())
        write();
}

// Not here: whoever sends may be in the middle of going through all peers.
void web_connection::session::give_up()
{
    finishing = true;
    asio::post(socket.get_executor(), [self = shared_from_this()] { self->close(); });
}

void web_connection::session::write()
{
    writing = true;
    ws->text(true);
    ws->async_write(asio::buffer(queue.front()),
                    [self = shared_from_this()](const beast::error_code& e, std::size_t) {
                        self->writing = false;
                        if (self->closed)
                            return;
                        if (e)
                            return self->close();
                        self->share.take(self->queue.front().size());
                        self->queue.pop_front();
                        if (!self->queue.empty())
                            self->write();
                        else if (self->finishing)
                            self->finish(self->why);
                    });
}

void web_connection::session::finish(const websocket::close_reason& r)
{
    if (closed || closing)
        return;
    if (!finishing)
        why = r;
    finishing = true;
    reading = false;
    deadline.cancel();
    hang_up_soon();
    if (!accepted)
        return close();
    if (!queue.empty() || !ws->is_open())
        return;
    closing = true;
    ws->async_close(why, [self = shared_from_this()](const beast::error_code&) { self->close(); });
}

void web_connection::session::hang_up_soon()
{
    lingering.expires_after(to_hang_up);
    lingering.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        if (!e)
            self->close();
    });
}

void web_connection::session::arm(double seconds)
{
    armed = true;
    deadline.expires_after(steady_seconds(seconds));
    deadline.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        // It may have been set anew while this was on its way.
        if (e || !self->armed || self->closed ||
            self->deadline.expiry() > asio::steady_timer::clock_type::now())
            return;
        if (self->accepted && self->ws->is_open())
            self->finish({websocket::close_code::policy_error,
                          self->met ? "a message took too long" : "the first message did not come"});
        else if (!self->accepted && !self->answered && self->parser.got_some())
            self->respond({408, "text/plain", "the request took too long\n", ""});
        else
            self->close();
    });
}

void web_connection::session::close()
{
    if (closed)
        return;
    closed = true;
    deadline.cancel();
    lingering.cancel();
    boost::system::error_code ignored;
    socket.shutdown(asio::socket_base::shutdown_send, ignored);
    socket.close(ignored);
    if (calls.closed)
        asio::post(deadline.get_executor(), [self = shared_from_this()] {
            const auto h = std::exchange(self->calls, {});
            h.closed();
        });
}

std::optional<asio::ip::tcp::socket> web_socket(asio::io_context& io, line_connection::socket_type taken)
{
    boost::system::error_code failed;
    const bool old = taken.local_endpoint(failed).protocol().family() == AF_INET;
    if (failed)
        return {};
    asio::ip::tcp::socket stream(io);
    const int fd = taken.release();
    stream.assign(old ? asio::ip::tcp::v4() : asio::ip::tcp::v6(), fd, failed);
    if (failed) {
        ::close(fd);
        return {};
    }
    stream.set_option(asio::ip::tcp::no_delay(true), failed);
    return stream;
}

web_connection::web_connection(socket_type s, const line_limits& l, write_budget& all,
                               std::vector<std::string> allowed_hosts)
    : session_(std::make_shared<session>(std::move(s), l, all, std::move(allowed_hosts)))
{
}

web_connection::~web_connection() = default;

void web_connection::start(handlers h)
{
    session_->calls = std::move(h);
    session_->read_request();
}

void web_connection::send(std::string text)
{
    session_->send(std::move(text));
}

void web_connection::finish()
{
    session_->finish(websocket::close_code::going_away);
}

void web_connection::turn_out(const char* why)
{
    session_->finish({websocket::close_code::policy_error, why});
}

std::size_t web_connection::waiting() const noexcept
{
    return session_->share.waiting();
}

} // namespace tactor::net
