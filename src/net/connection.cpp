// SPDX-License-Identifier: MIT
#include "net/connection.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace tactor::net {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::seconds linger{1};

// Greatest number of large messages of a peer that may wait. At this number, reading from the peer pauses.
constexpr unsigned most_large = 4;

constexpr std::size_t chunk_bytes = 16U << 10;
constexpr std::size_t most_drained = 128U << 10;
constexpr std::size_t lines_at_once = 16;
constexpr char line_end = '\n';

constexpr auto accept_pause = std::chrono::milliseconds(100);

} // namespace

connection::connection(const asio::any_io_executor& executor, const message_limits& l)
    : limits_(l), deadline_(executor), linger_(executor)
{
}

void connection::start(peer_handlers h)
{
    handlers_ = std::move(h);
    arm(limits_.message_s);
    begin_reading();
}

void connection::handle(std::string_view text)
{
    const auto self = shared_from_this();
    if (text.empty())
        return read();
    if (handled(handlers_.message(text)))
        read();
}

void connection::handle_large_message(std::string text)
{
    ++large_;
    handlers_.large(std::move(text), [self = shared_from_this()](bool go_on) {
        const bool waited = self->large_-- == most_large;
        if (self->handled(go_on) && waited)
            self->read();
    });
    if (large_ < most_large)
        read();
}

// Continues after a message has been handled. Returns true if reading should continue.
bool connection::handled(bool go_on)
{
    if (closed_ || finishing_)
        return false;
    if (!go_on)
        dismiss("the message is not accepted");
    if (reading_ && !met_ && (!handlers_.met || handlers_.met())) {
        met_ = true;
        disarm();
    }
    return reading_;
}

void connection::begin_message()
{
    if (!armed_)
        arm(limits_.message_s);
}

void connection::end_message()
{
    if (met_)
        disarm();
}

void connection::arm(double seconds)
{
    armed_ = true;
    deadline_.expires_after(to_steady_duration(seconds));
    deadline_.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        // The timer may have been restarted after this handler was queued.
        if (!e && self->armed_ && !self->closed_ &&
            self->deadline_.expiry() <= asio::steady_timer::clock_type::now())
            self->time_out();
    });
}

void connection::disarm()
{
    if (std::exchange(armed_, false))
        deadline_.cancel();
}

void connection::queue(std::string message, bool file)
{
    if (closed_ || finishing_)
        return;
    if (!file && waiting_ + message.size() > limits_.waiting_bytes) {
        finishing_ = true;
        // Closes the connection later, because the caller may be iterating over all connections.
        return asio::post(executor(), [self = shared_from_this()] { self->close(); });
    }
    (file ? file_bytes_ : waiting_) += message.size();
    queue_.push_back({std::move(message), file});
    if (!writing_ && may_write_)
        continue_writing();
}

void connection::continue_writing()
{
    if (queue_.empty()) {
        if (finishing_)
            close_with_handshake();
        return;
    }
    writing_ = true;
    write();
}

void connection::on_written(std::size_t messages)
{
    writing_ = false;
    if (closed_)
        return;
    for (; messages != 0; --messages) {
        const outgoing& first = queue_.front();
        (first.file ? file_bytes_ : waiting_) -= first.text.size();
        queue_.pop_front();
    }
    continue_writing();
}

void connection::fail(connection_fault f)
{
    if (closed_)
        return;
    stop_reading();
    if (f == connection_fault::gone)
        return close();
    if (handlers_.fault)
        handlers_.fault(f);
    dismiss(f == connection_fault::memory ? "there is not enough memory for the message"
            : met_                        ? "a message took too long"
                                          : "the first message did not come");
}

void connection::stop_reading()
{
    reading_ = false;
    disarm();
}

void connection::finish()
{
    if (closed_ || finishing_)
        return;
    stop_reading();
    finishing_ = true;
    start_close_timer();
    if (!writing_ && may_write_)
        continue_writing();
}

void connection::start_close_timer()
{
    linger_.expires_after(linger);
    linger_.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        if (!e)
            self->close();
    });
}

void connection::close()
{
    if (closed_)
        return;
    const auto self = shared_from_this();
    closed_ = true;
    stop_reading();
    linger_.cancel();
    close_socket();
    if (handlers_.closed)
        asio::post(executor(), [self] {
            const auto h = std::exchange(self->handlers_, {});
            h.closed();
        });
}

line_connection::line_connection(socket_type s, const message_limits& l)
    : connection(s.get_executor(), l), socket_(std::move(s)), chunk_(chunk_bytes)
{
}

// Handles one line, then returns to the context, so that other peers get their turns.
void line_connection::read()
{
    if (!reads())
        return;
    scanned_ = std::min(text_.find(line_end, scanned_), text_.size());
    if (scanned_ == text_.size())
        return read_more();
    asio::post(executor(), [this, self = shared_from_this()] { catch_bad_alloc([&] { next_line(); }); });
}

void line_connection::next_line()
{
    if (!reads())
        return;
    std::string_view line = std::string_view(text_).substr(begin_, scanned_ - begin_);
    if (line.ends_with('\r'))
        line.remove_suffix(1);
    begin_ = ++scanned_;
    if (line.size() > limits().message_bytes)
        return fail(connection_fault::too_long);
    end_message();
    if (line.size() <= large_message)
        return handle(line);
    if (line.data() != text_.data() || scanned_ != text_.size())
        return handle_large_message(std::string(line));
    // Moves the text instead of copying it. If messages from sixty peers ended at the same time, a stop would
    // have to wait for sixty copies.
    text_.resize(line.size());
    begin_ = scanned_ = 0;
    handle_large_message(std::exchange(text_, {}));
}

void line_connection::read_more()
{
    text_.erase(0, std::exchange(begin_, 0));
    const bool may_end = text_.ends_with('\r');
    if (text_.size() > limits().message_bytes + (may_end ? 1 : 0))
        return fail(connection_fault::too_long);
    if (text_.size() <= chunk_.size() && text_.capacity() > large_message)
        text_.shrink_to_fit(); // frees the memory of a large message
    scanned_ = text_.size();
    if (over_) {
        stop_reading();
        // Detects a closed connection. A Unix socket reports it when the peer closes, TCP when data is
        // written.
        socket_.async_wait(socket_type::wait_error,
                           [this, self = shared_from_this()](const boost::system::error_code& e) {
                               if (!e)
                                   fail(connection_fault::gone);
                           });
        return calls().input_ended();
    }
    if (!text_.empty())
        begin_message();
    socket_.async_read_some(asio::buffer(chunk_), [this, self = shared_from_this()](
                                                      const boost::system::error_code& e, std::size_t n) {
        if (closed() || e == asio::error::operation_aborted)
            return;
        if (e && e != asio::error::eof)
            return fail(connection_fault::gone);
        catch_bad_alloc([&] {
            over_ = e.failed();
            if (text_.size() > large_message)
                text_.reserve(bytes_to_reserve(limits()));
            text_.append(chunk_.data(), n);
            // The end of the input also ends the last line. An incomplete line is not valid JSON, so the peer
            // gets an error.
            if (over_ && !text_.empty())
                text_ += line_end;
            read();
        });
    });
}

void line_connection::write()
{
    const std::size_t lines = std::min(queued().size(), lines_at_once);
    std::vector<asio::const_buffer> buffers;
    for (std::size_t i = 0; i < lines; ++i) {
        buffers.push_back(asio::buffer(queued()[i].text));
        buffers.push_back(asio::buffer(&line_end, 1));
    }
    asio::async_write(
        socket_, buffers,
        [this, self = shared_from_this(), lines](const boost::system::error_code& e, std::size_t) {
            if (e)
                fail(connection_fault::gone);
            else
                on_written(lines);
        });
}

void line_connection::close_socket()
{
    boost::system::error_code ignored;
    // Reads the rest of the input. Closing a socket with unread input resets the connection, and the last
    // message could be lost.
    socket_.shutdown(asio::socket_base::shutdown_send, ignored);
    for (std::size_t drained = 0; drained < most_drained && socket_.available(ignored) != 0 && !ignored;)
        drained += socket_.read_some(asio::buffer(chunk_), ignored);
    socket_.close(ignored);
}

listener::listener(asio::io_context& io, int fd, std::string when_full,
                   std::function<void(socket_type)> taken, std::function<void()> turned_away)
    : io_(io),
      fd_(io, fd),
      pause_(io),
      when_full_(std::move(when_full)),
      taken_(std::move(taken)),
      turned_away_(std::move(turned_away))
{
    reserve_descriptor();
}

listener::~listener()
{
    fd_.release();
}

void listener::reserve_descriptor() noexcept
{
    if (!spare_)
        spare_ = detail::owned_fd(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

void listener::start()
{
    fd_.async_wait(asio::posix::descriptor_base::wait_read, [this](const boost::system::error_code& e) {
        if (!e)
            take();
    });
}

void listener::stop()
{
    boost::system::error_code ignored;
    fd_.cancel(ignored);
    pause_.cancel();
}

void listener::take()
{
    sockaddr address{};
    socklen_t size = sizeof address;
    const int fd = ::accept4(fd_.native_handle(), &address, &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd >= 0) {
        boost::system::error_code failed;
        socket_type s(io_);
        s.assign(asio::generic::stream_protocol(address.sa_family, 0), fd, failed);
        if (failed)
            ::close(fd);
        else
            try {
                taken_(std::move(s));
            } catch (const std::bad_alloc&) { // NOLINT(bugprone-empty-catch): this socket closes, others stay
            }
        return start();
    }
    if (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED)
        return start();
    if ((errno == EMFILE || errno == ENFILE) && reject_client()) {
        if (turned_away_)
            turned_away_();
        return start();
    }
    // There is not enough memory, or another process has taken the spare descriptor. Trying again immediately
    // would waste processor time.
    pause_.expires_after(accept_pause);
    pause_.async_wait([this](const boost::system::error_code& e) {
        if (!e)
            start();
    });
}

// Accepts a client on the spare descriptor, sends as much of the refusal as the socket accepts, and closes
// the connection.
bool listener::reject_client() noexcept
{
    reserve_descriptor();
    if (!spare_)
        return false;
    spare_.close();
    detail::owned_fd next(::accept4(fd_.native_handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    const bool came = static_cast<bool>(next);
    if (came)
        static_cast<void>(
            ::send(next.get(), when_full_.data(), when_full_.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
    next.close();
    reserve_descriptor();
    return came;
}

} // namespace tactor::net
