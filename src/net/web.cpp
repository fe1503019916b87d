// SPDX-License-Identifier: MIT
#include "net/web.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include "net/access.hpp"
#include "net/rpc.hpp"

namespace tactor::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr std::size_t most_header_bytes = 8U << 10;
constexpr std::size_t read_at_once = 16U << 10;

// Greatest number of WebSockets of a page. There are the page itself, reloads of it and a few accidental
// visitors.
constexpr std::size_t most_visitors = 16;
constexpr std::size_t most_connections = 32;
// Limits for messages with a text of 2,000 characters. In JSON a character takes up to six bytes.
constexpr message_limits page_limits{
    .message_bytes = 16U << 10, .message_s = 10.0, .waiting_bytes = 1U << 20};

std::string_view view(boost::string_view s)
{
    return {s.data(), s.size()};
}

// Returns a complete HTTP reply with status 503.
std::string unavailable(std::string_view why)
{
    const std::string text = fmt::format("{}, try again later\n", why);
    return fmt::format("HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\n"
                       "Content-Length: {}\r\nConnection: close\r\n\r\n{}",
                       text.size(), text);
}

class web_connection final : public connection {
public:
    using socket_type = asio::ip::tcp::socket;

    web_connection(socket_type s, const message_limits& l, std::vector<std::string> hosts,
                   std::string_view socket_path);

    void finish() override;
    /// Closes the WebSocket with status 1008.
    void dismiss(const char* reason) override;

private:
    void close_socket() override;
    void time_out() override;
    // Members for an HTTP request:
    void begin_reading() override;
    void answer_request();
    void respond(web_reply r);
    void upgrade();
    // Members for a WebSocket:
    void set_pings(bool is_read);
    void read() override;
    void handle_message();
    void write() override;
    void close_with_handshake() override;

    std::vector<std::string> allowed_;
    std::string_view socket_path_;
    std::string local_;
    socket_type socket_;
    asio::steady_timer later_; ///< timer that delays a reply
    beast::flat_buffer buffer_;
    http::request_parser<http::empty_body> parser_;
    http::response<http::string_body> response_;
    std::optional<websocket::stream<socket_type&>> ws_;
    websocket::close_reason why_{websocket::close_code::going_away};
    bool answered_ = false;   ///< true once a page or a refusal has been sent
    bool looks_ = false;      ///< true while pings check the connection
    bool is_reading_ = false; ///< true while part of a message is being read
};

web_connection::web_connection(socket_type s, const message_limits& l, std::vector<std::string> hosts,
                               std::string_view socket_path)
    : connection(s.get_executor(), l),
      allowed_(std::move(hosts)),
      socket_path_(socket_path),
      local_(local_address(s.native_handle())),
      socket_(std::move(s)),
      later_(socket_.get_executor())
{
    allow_writing(false);
    parser_.header_limit(most_header_bytes);
    parser_.body_limit(std::numeric_limits<std::uint64_t>::max()); // no body is read
}

void web_connection::begin_reading()
{
    http::async_read_header(
        socket_, buffer_, parser_,
        [this, self = shared_from_this()](const beast::error_code& e, std::size_t) {
            if (closed() || answered_)
                return;
            disarm();
            if (e == http::error::header_limit)
                respond({413, "text/plain", "the request is too large\n", ""});
            else if (e && e.category() == make_error_code(http::error::bad_target).category() &&
                     e != http::error::end_of_stream && e != http::error::partial_message)
                respond({400, "text/plain", "not an HTTP request\n", ""});
            else if (e)
                close();
            else
                answer_request();
        });
}

void web_connection::answer_request()
{
    const auto& request = parser_.get();
    const std::string host_header(view(request[http::field::host]));
    const web_target to = parse_target(view(request.target()), host_header);
    const auto origins = request.equal_range(http::field::origin);
    const bool one_host = request.count(http::field::host) == 1;
    bool ours = one_host && is_server_host(host_header, local_, allowed_) &&
                is_server_host(to.host, local_, allowed_);
    for (auto o = origins.first; o != origins.second; ++o)
        ours = ours && is_server_origin(view(o->value()), to.host, allowed_);
    if (!ours && calls().refused)
        calls().refused(fmt::format(
            "a browser's request for the host \"{}\"{}", truncate_echo(host_header),
            origins.first == origins.second
                ? ""
                : fmt::format(" by a page of \"{}\"", truncate_echo(view(origins.first->value())))));
    if (!ours)
        return respond({403, "text/plain",
                        "this host name or page does not belong to this server, whose owner can add names to "
                        "allow_hosts\n",
                        ""});
    if (request.method() != http::verb::get && request.method() != http::verb::head)
        return respond({405, "text/plain", "only GET and HEAD are allowed\n", ""});
    if (parser_.chunked() || parser_.content_length().value_or(0) > 0)
        return respond({413, "text/plain", "the request is too large\n", ""});
    if (to.path == socket_path_ && websocket::is_upgrade(request))
        return upgrade();
    if (to.path == socket_path_)
        return respond({426, "text/plain", "a WebSocket\n", ""});
    respond(calls().get(to.path, to.host, bearer_token(view(request[http::field::authorization]))));
}

// Sends the reply and closes the connection. Each connection serves only one request, because a page makes
// few requests.
void web_connection::respond(web_reply r)
{
    answered_ = true;
    response_.result(r.status);
    response_.version(11);
    response_.set(http::field::server, "tactor");
    response_.set(http::field::content_type, r.type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Content-Security-Policy",
                  r.policy.empty() ? "default-src 'none'; frame-ancestors 'none'" : r.policy);
    if (r.status == 405)
        response_.set(http::field::allow, "GET, HEAD");
    if (r.status == 426) {
        response_.set(http::field::upgrade, "websocket");
        response_.set(http::field::connection, "upgrade, close");
    }
    if (!r.gzip.empty()) {
        response_.set(http::field::vary, "Accept-Encoding");
        if (http::ext_list(parser_.get()[http::field::accept_encoding]).exists("gzip")) {
            response_.set(http::field::content_encoding, "gzip");
            r.body = std::move(r.gzip);
        }
    }
    response_.body() = std::move(r.body);
    if (r.status != 426)
        response_.keep_alive(false);
    response_.prepare_payload();
    if (parser_.get().method() == http::verb::head)
        response_.body().clear(); // the header keeps the length of the body
    later_.expires_after(to_steady_duration(r.after_s));
    later_.async_wait([this, self = shared_from_this()](const beast::error_code& e) {
        if (e || closed())
            return;
        arm(limits().message_s);
        http::async_write(socket_, response_,
                          [this, self](const beast::error_code&, std::size_t) { close(); });
    });
}

void web_connection::upgrade()
{
    if (!calls().upgrade())
        return respond({503, "text/plain", "all places are taken, try again later\n", ""});
    ws_.emplace(socket_);
    set_pings(true);
    ws_->read_message_max(limits().message_bytes);
    // Splits long messages into frames, so that pings and pongs can be sent between frames. On a slow link a
    // message may take longer than the timeout of 20 s.
    ws_->auto_fragment(true);
    ws_->write_buffer_bytes(large_message);
    ws_->set_option(websocket::stream_base::decorator(
        [](websocket::response_type& r) { r.set(http::field::server, "tactor"); }));
    // If the browser sends a close frame, it gets one second to close the connection.
    ws_->control_callback([this](websocket::frame_type kind, boost::string_view) {
        if (kind == websocket::frame_type::close)
            start_close_timer();
    });
    ws_->async_accept(parser_.get(), [this, self = shared_from_this()](const beast::error_code& e) {
        if (closed())
            return;
        if (e)
            return close();
        buffer_.consume(buffer_.size());
        if (!calls().may_only_read)
            arm(limits().message_s);
        allow_writing(true);
        read();
        continue_writing();
    });
}

// Turns pings on or off. Sent every 10 s, they check that the browser still responds and does not stop in the
// middle of a frame header. They are off while nothing is read, because the answers would not be read either.
void web_connection::set_pings(bool is_read)
{
    websocket::stream_base::timeout t{};
    t.handshake_timeout = to_steady_duration(limits().message_s);
    t.idle_timeout = is_read ? std::chrono::seconds(20) : websocket::stream_base::none();
    t.keep_alive_pings = is_read;
    ws_->set_option(t);
    looks_ = is_read;
}

void web_connection::read()
{
    if (!reads())
        return;
    if (!looks_)
        set_pings(true);
    is_reading_ = true;
    ws_->async_read_some(buffer_, read_at_once,
                         [this, self = shared_from_this()](const beast::error_code& e, std::size_t) {
                             is_reading_ = false;
                             if (closed())
                                 return;
                             if (e)
                                 return close(); // Beast has sent the reason if the browser is still there
                             catch_bad_alloc([this] { handle_message(); });
                         });
}

void web_connection::handle_message()
{
    if (!ws_->is_message_done()) {
        begin_message();
        if (buffer_.size() > large_message)
            buffer_.reserve(bytes_to_reserve(limits()));
        return read();
    }
    end_message();
    if (!ws_->got_text()) {
        why_ = {websocket::close_code::unknown_data, "only text is accepted"};
        return finish();
    }
    std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    if (buffer_.capacity() > large_message)
        buffer_.shrink_to_fit();
    if (text.size() <= large_message)
        return handle(text);
    handle_large_message(std::move(text));
    if (!is_reading_)
        set_pings(false);
}

void web_connection::write()
{
    ws_->async_write(asio::buffer(queued().front().text),
                     [this, self = shared_from_this()](const beast::error_code& e, std::size_t) {
                         if (e)
                             close();
                         else
                             on_written(1);
                     });
}

void web_connection::close_with_handshake()
{
    ws_->async_close(why_, [this, self = shared_from_this()](const beast::error_code&) { close(); });
}

void web_connection::dismiss(const char* reason)
{
    if (!is_finishing())
        why_ = {websocket::close_code::policy_error, reason};
    finish();
}

void web_connection::finish()
{
    if (ws_)
        connection::finish();
    else
        close();
}

void web_connection::time_out()
{
    if (ws_)
        fail(connection_fault::too_slow);
    else if (!answered_ && parser_.got_some())
        respond({408, "text/plain", "the request took too long\n", ""});
    else
        close();
}

void web_connection::close_socket()
{
    later_.cancel();
    boost::system::error_code ignored;
    socket_.shutdown(asio::socket_base::shutdown_send, ignored);
    socket_.close(ignored);
}

} // namespace

std::shared_ptr<connection> connect_browser(asio::io_context& io,
                                            asio::generic::stream_protocol::socket accepted,
                                            const message_limits& l, std::vector<std::string> allowed_hosts,
                                            std::string_view socket_path)
{
    boost::system::error_code failed;
    const bool old = accepted.local_endpoint(failed).protocol().family() == AF_INET;
    if (failed)
        return nullptr;
    asio::ip::tcp::socket stream(io);
    const int fd = accepted.release();
    stream.assign(old ? asio::ip::tcp::v4() : asio::ip::tcp::v6(), fd, failed);
    if (failed) {
        ::close(fd);
        return nullptr;
    }
    stream.set_option(asio::ip::tcp::no_delay(true), failed);
    return std::make_shared<web_connection>(std::move(stream), l, std::move(allowed_hosts), socket_path);
}

web_reply make_page(const page_document& document, std::string_view host)
{
    return {200, "text/html; charset=utf-8", std::string(document.text),
            fmt::format("default-src 'none'; {}; img-src data:; "
                        "connect-src 'self' ws://{}; frame-ancestors 'none'; base-uri 'none'; "
                        "form-action 'none'",
                        document.policy, host),
            std::string(document.gzip)};
}

void reject_client(int socket)
{
    const std::string why = unavailable("all places are taken");
    static_cast<void>(::send(socket, why.data(), why.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}

std::string no_descriptor_reply()
{
    return unavailable("the server has too many open files");
}

page_server::page_server(owned_fd listening, const page_document& document, handlers h)
    : fd_(std::move(listening)),
      document_(document),
      calls_(std::move(h)),
      door_(io_, fd_.get(), no_descriptor_reply(), [this](listener::socket_type s) { take(std::move(s)); })
{
    door_.start();
    thread_ = std::thread([this] { io_.run(); });
}

page_server::~page_server()
{
    asio::post(io_, [this] {
        door_.stop();
        for (const auto& c : std::set(all_))
            c->finish();
        work_.reset();
    });
    thread_.join();
}

void page_server::take(listener::socket_type s)
{
    if (all_.size() >= most_connections)
        return reject_client(s.native_handle()); // the destructor of `s` closes the socket
    const auto c = connect_browser(io_, std::move(s), page_limits, {});
    if (!c)
        return;
    all_.insert(c);
    const visitor n = ++last_;
    c->start({.message = [this, n](std::string_view text) { return calls_.on_text(n, text); },
              .closed =
                  [this, n, weak = std::weak_ptr(c)] {
                      all_.erase(weak.lock());
                      if (visitors_.erase(n) != 0)
                          calls_.on_leave(n);
                  },
              .get =
                  [this](std::string_view path, std::string_view host, std::string_view) {
                      return path == "/"
                                 ? make_page(document_, host)
                                 : web_reply{404, "text/plain", "this server has only / and /rpc\n", ""};
                  },
              .upgrade =
                  [this, n, weak = std::weak_ptr(c)] {
                      return visitors_.size() < most_visitors && visitors_.emplace(n, weak.lock()).second;
                  }});
}

void page_server::send(visitor to, std::string text)
{
    asio::post(io_, [this, to, text = std::move(text)]() mutable {
        if (const auto found = visitors_.find(to); found != visitors_.end())
            found->second->send(std::move(text));
    });
}

void page_server::finish(visitor v)
{
    asio::post(io_, [this, v] {
        if (const auto found = visitors_.find(v); found != visitors_.end())
            found->second->finish();
    });
}

} // namespace tactor::net
