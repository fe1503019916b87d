// SPDX-License-Identifier: MIT
// A browser's request and its answer: a page, a refusal, or a WebSocket.
#include <chrono>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>
#include <sys/socket.h>

#include "net/access.hpp"
#include "net/listen.hpp"
#include "net/web_session.hpp"

namespace tactor::net {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

constexpr std::size_t most_header_bytes = 8U << 10;

std::string_view view(boost::string_view s)
{
    return {s.data(), s.size()};
}

// Returns a whole reply.
std::string unavailable(std::string_view why)
{
    const std::string text = fmt::format("{}, try again later\n", why);
    return fmt::format("HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\n"
                       "Content-Length: {}\r\nConnection: close\r\n\r\n{}",
                       text.size(), text);
}

} // namespace

web_session::web_session(socket_type s, const line_limits& l, shared_by_peers& all,
                         std::vector<std::string> hosts)
    : limits(l),
      unread(all.unread, [this] { give_up(); }),
      unfinished(all.unfinished, [this] { give_up_crowded(); }),
      turns(all.turns),
      small(all.small),
      allowed(std::move(hosts)),
      local(local_address(s.native_handle())),
      socket(std::move(s)),
      deadline(socket.get_executor()),
      lingering(socket.get_executor())
{
    parser.header_limit(most_header_bytes);
    parser.body_limit(std::numeric_limits<std::uint64_t>::max()); // no body is read
}

void web_session::read_request()
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

void web_session::answer_request()
{
    const auto& request = parser.get();
    const std::string host_header(view(request[http::field::host]));
    const web_target to = parse_target(view(request.target()), host_header);
    const auto origins = request.equal_range(http::field::origin);
    const bool one_host = request.count(http::field::host) == 1;
    bool ours =
        one_host && host_is_ours(host_header, local, allowed) && host_is_ours(to.host, local, allowed);
    for (auto o = origins.first; o != origins.second; ++o)
        ours = ours && origin_is_ours(view(o->value()), to.host, allowed);
    if (!ours)
        return respond(
            {403, "text/plain",
             "another name or another page than this server's: its owner lists more in allow_hosts\n", ""});
    if (request.method() != http::verb::get && request.method() != http::verb::head)
        return respond({405, "text/plain", "GET and HEAD only\n", ""});
    if (parser.chunked() || parser.content_length().value_or(0) > 0)
        return respond({413, "text/plain", "too much\n", ""});
    if (to.path == "/rpc" && websocket::is_upgrade(request))
        return upgrade();
    if (to.path == "/rpc")
        return respond({426, "text/plain", "a WebSocket\n", ""});
    respond(calls.get(to.path, to.host, bearer_token(view(request[http::field::authorization]))));
}

// Sends the reply and closes. One request for each connection, because a page asks for little.
void web_session::respond(web_reply r)
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
        response.set(http::field::allow, "GET, HEAD");
    if (r.status == 426) {
        response.set(http::field::upgrade, "websocket");
        response.set(http::field::connection, "upgrade, close");
    }
    if (!r.gzip.empty()) {
        response.set(http::field::vary, "Accept-Encoding");
        if (http::ext_list(parser.get()[http::field::accept_encoding]).exists("gzip")) {
            response.set(http::field::content_encoding, "gzip");
            r.body = std::move(r.gzip);
        }
    }
    response.body() = std::move(r.body);
    if (r.status != 426)
        response.keep_alive(false);
    response.prepare_payload();
    if (parser.get().method() == http::verb::head)
        response.body().clear(); // the header still gives its length
    if (r.after_s == 0.0)
        return send_response();
    lingering.expires_after(steady_seconds(r.after_s));
    lingering.async_wait([self = shared_from_this()](const beast::error_code& e) {
        if (!e && !self->closed)
            self->send_response();
    });
}

void web_session::send_response()
{
    arm(limits.message_s);
    http::async_write(socket, response,
                      [self = shared_from_this()](const beast::error_code&, std::size_t) { self->close(); });
}

void web_session::upgrade()
{
    if (!calls.upgrade())
        return respond({503, "text/plain", "there is no place, try again later\n", ""});
    accepted = true;
    ws.emplace(
        socket,
        [this](std::span<const std::byte> bytes) {
            frames.take(bytes);
            watch();
        },
        [this] { return frames.has_bad_reason(); });
    websocket::stream_base::timeout t{};
    t.handshake_timeout = steady_seconds(limits.message_s);
    // Pings detect a browser that disappeared.
    t.idle_timeout = std::chrono::seconds(60);
    t.keep_alive_pings = true;
    ws->set_option(t);
    ws->read_message_max(limits.message_bytes);
    ws->auto_fragment(false);
    ws->set_option(websocket::stream_base::decorator(
        [](websocket::response_type& r) { r.set(http::field::server, "tactor"); }));
    // A peer that sends a close frame has a second to hang up.
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

web_reply make_page(const page_document& document, std::string_view host)
{
    return {200, "text/html; charset=utf-8", std::string(document.text),
            fmt::format("default-src 'none'; {}; img-src data:; manifest-src blob:; "
                        "connect-src 'self' ws://{}; frame-ancestors 'none'; base-uri 'none'; "
                        "form-action 'none'",
                        document.policy, host),
            std::string(document.gzip)};
}

void turn_away(int socket)
{
    const std::string why = unavailable("there is no place");
    static_cast<void>(::send(socket, why.data(), why.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}

std::string no_descriptors_for_browsers()
{
    return unavailable("the server has as many files open as it may");
}

} // namespace tactor::net
