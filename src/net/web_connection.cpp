// SPDX-License-Identifier: MIT
#include "net/web_connection.hpp"

#include <chrono>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "net/web_session.hpp"

namespace tactor::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

constexpr std::chrono::seconds to_hang_up{1};

} // namespace

// Works like line_connection::within_memory().
template <typename F>
void web_session::within_memory(F f)
{
    try {
        f();
    } catch (const std::bad_alloc&) {
        finish({websocket::close_code::policy_error, "there is not enough memory for it"});
    }
}

void web_session::read()
{
    if (!reading || closed)
        return;
    ws->async_read_some(buffer, 16U << 10,
                        [self = shared_from_this()](const beast::error_code& e, std::size_t) {
                            if (self->closed)
                                return;
                            if (e)
                                return self->close(); // Beast has sent the reason, if the peer is there
                            self->within_memory([&] { self->received(); });
                        });
}

void web_session::received()
{
    if (!unfinished.hold(buffer.capacity()))
        return;
    if (!ws->is_message_done())
        return read();
    constexpr std::size_t much = 64U << 10;
    std::string text(static_cast<const char*>(buffer.data().data()), buffer.size());
    buffer.consume(buffer.size());
    if (buffer.capacity() > much)
        buffer.shrink_to_fit();
    if (!ws->got_text())
        return finish({websocket::close_code::unknown_data, "text is taken"});
    if (text.size() > small_message && calls.large) {
        if (unfinished.hold(buffer.capacity() + text.size()))
            turns.join([self = shared_from_this(), text = std::move(text)]() mutable {
                self->handle_large(std::move(text));
            });
        return;
    }
    if (text.empty() || (calls.urgent && calls.urgent(text)))
        return handled(text.empty(), text.empty() || calls.message(text));
    small.join([self = shared_from_this(), text = std::move(text)] {
        if (!self->closed && !self->finishing)
            self->within_memory([&] { self->handled(false, self->calls.message(text)); });
    });
}

void web_session::handle_large(std::string text)
{
    if (closed || finishing)
        return turns.pass();
    const auto done = [self = shared_from_this()](bool go_on) {
        self->turns.pass();
        if (!self->closed && !self->finishing && self->unfinished.hold(self->buffer.capacity()))
            self->within_memory([&] { self->handled(false, go_on); });
    };
    try {
        calls.large(std::move(text), done);
    } catch (const std::bad_alloc&) {
        turns.pass();
        finish({websocket::close_code::policy_error, "there is not enough memory for it"});
    }
}

void web_session::handled(bool empty, bool go_on)
{
    if (!go_on)
        return finish({websocket::close_code::policy_error, "this is not taken"});
    if (!met && !empty && (!calls.met || calls.met())) {
        met = true;
        disarm();
        watch();
    }
    read();
}

// Notices frames that begin. Beast reports payload only: no head alone, and no fragment without payload.
void web_session::watch()
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

void web_session::disarm()
{
    if (std::exchange(armed, false))
        deadline.cancel();
}

void web_session::enqueue(std::string text, bool large)
{
    if (closed || finishing || !accepted)
        return;
    const std::size_t n = text.size();
    if (!large && unread.held() - large_bytes + n > limits.waiting_bytes)
        unread.give_up();
    if (!unread.add(n))
        return;
    large_bytes += large ? n : 0;
    queue.push_back({std::move(text), large});
    if (!writing && ws && ws->is_open())
        write();
}

// Does not close here, because the caller may be iterating over all peers.
void web_session::give_up()
{
    finishing = true;
    asio::post(socket.get_executor(), [self = shared_from_this()] { self->close(); });
}

void web_session::give_up_crowded()
{
    reading = false;
    asio::post(socket.get_executor(), [self = shared_from_this()] {
        self->finish(
            {websocket::close_code::try_again_later, "unfinished messages of all clients are too many"});
    });
}

void web_session::write()
{
    writing = true;
    ws->text(true);
    ws->async_write(asio::buffer(queue.front().text),
                    [self = shared_from_this()](const beast::error_code& e, std::size_t) {
                        self->writing = false;
                        if (self->closed)
                            return;
                        if (e)
                            return self->close();
                        const queued_text& written = self->queue.front();
                        self->unread.take(written.text.size());
                        self->large_bytes -= written.large ? written.text.size() : 0;
                        self->queue.pop_front();
                        if (!self->queue.empty())
                            self->write();
                        else if (self->finishing)
                            self->finish(self->why);
                    });
}

void web_session::finish(const websocket::close_reason& r)
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

void web_session::hang_up_soon()
{
    lingering.expires_after(to_hang_up);
    lingering.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        if (!e)
            self->close();
    });
}

void web_session::arm(double seconds)
{
    armed = true;
    deadline.expires_after(steady_seconds(seconds));
    deadline.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        // The timer may have been set again while this was queued.
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

void web_session::close()
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

void web_session::start(peer_handlers h)
{
    calls = std::move(h);
    read_request();
}

void web_session::finish()
{
    finish(websocket::close_code::going_away);
}

void web_session::turn_out(const char* reason)
{
    finish({websocket::close_code::policy_error, reason});
}

std::shared_ptr<web_connection> connect_browser(asio::io_context& io, line_connection::socket_type accepted,
                                                const line_limits& l, shared_by_peers& all,
                                                std::vector<std::string> allowed_hosts)
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
    return std::make_shared<web_session>(std::move(stream), l, all, std::move(allowed_hosts));
}

} // namespace tactor::net
