// SPDX-License-Identifier: MIT
#include "net/line_connection.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>

namespace tactor::net {
namespace {

constexpr std::size_t chunk_bytes = 16U << 10;
constexpr std::size_t lines_at_once = 16;
constexpr std::chrono::seconds linger{1};

} // namespace

line_connection::line_connection(socket_type s, const line_limits& l, write_budget& all)
    : socket_(std::move(s)),
      limits_(l),
      share_(all, [this] { give_up_unread(); }),
      deadline_(socket_.get_executor()),
      linger_(socket_.get_executor()),
      chunk_(chunk_bytes)
{
}

line_connection::~line_connection() = default;

void line_connection::start(handlers h)
{
    handlers_ = std::move(h);
    arm(limits_.message_s);
    read();
}

void line_connection::read()
{
    if (!reading_ || closed_)
        return;
    socket_.async_read_some(boost::asio::buffer(chunk_),
                            [self = shared_from_this()](const boost::system::error_code& e, std::size_t n) {
                                if (self->closed_)
                                    return;
                                if (!e) {
                                    self->received(n);
                                } else if (e == boost::asio::error::eof) {
                                    self->last_line();
                                    if (self->closed_ || self->finishing_)
                                        return;
                                    self->reading_ = false;
                                    self->deadline_.cancel();
                                    self->watch();
                                    self->handlers_.input_ended();
                                } else if (e != boost::asio::error::operation_aborted) {
                                    self->give_up(line_fault::gone);
                                }
                            });
}

// A Unix socket says when its other end is closed as a whole; one of TCP when it is written to.
void line_connection::watch()
{
    socket_.async_wait(socket_type::wait_error,
                       [self = shared_from_this()](const boost::system::error_code& e) {
                           if (!e && !self->closed_)
                               self->give_up(line_fault::gone);
                       });
}

void line_connection::received(std::size_t n)
{
    partial_.append(chunk_.data(), n);
    const auto self = shared_from_this();
    if (!take_lines() || closed_ || !reading_)
        return;
    read();
}

// The end of the input ends a line, too: what was cut off is no JSON, and is told so.
void line_connection::last_line()
{
    if (!partial_.empty() && reading_) {
        partial_ += '\n';
        take_lines();
    }
}

// False when the connection is at its end.
bool line_connection::take_lines()
{
    std::size_t from = 0;
    for (std::size_t end = partial_.find('\n'); end != std::string::npos; end = partial_.find('\n', from)) {
        std::string_view line(partial_.data() + from, end - from);
        if (!line.empty() && line.back() == '\r')
            line.remove_suffix(1);
        if (line.size() > limits_.message_bytes) {
            give_up(line_fault::too_long);
            return false;
        }
        from = end + 1;
        if (!line.empty() && !handlers_.line(line)) {
            reading_ = false;
            return false;
        }
        if (closed_ || !reading_)
            return false;
        met_ = met_ || (!line.empty() && (!handlers_.met || handlers_.met()));
        if (met_) {
            armed_ = false;
            deadline_.cancel();
        }
    }
    partial_.erase(0, from);
    const bool may_end = !partial_.empty() && partial_.back() == '\r';
    if (partial_.size() > limits_.message_bytes + (may_end ? 1 : 0)) {
        give_up(line_fault::too_long);
        return false;
    }
    if (!partial_.empty() && !armed_)
        arm(limits_.message_s);
    return true;
}

void line_connection::arm(double seconds)
{
    armed_ = true;
    deadline_.expires_after(steady_seconds(seconds));
    deadline_.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        if (!e && self->armed_ && self->reading_ && !self->closed_)
            self->give_up(line_fault::too_slow);
    });
}

void line_connection::give_up(line_fault f)
{
    if (closed_)
        return;
    const auto self = shared_from_this();
    reading_ = false;
    if (handlers_.fault)
        handlers_.fault(f);
    if (f == line_fault::too_long || f == line_fault::too_slow)
        finish();
    else
        close();
}

void line_connection::send(std::string line)
{
    if (closed_ || finishing_)
        return;
    line += '\n';
    const std::size_t n = line.size();
    if (share_.waiting() + n > limits_.waiting_bytes)
        share_.give_up();
    if (!share_.add(n))
        return;
    queue_.push_back(std::move(line));
    if (in_flight_ == 0)
        write();
}

// Not here: whoever sends may be in the middle of going through all peers.
void line_connection::give_up_unread()
{
    finishing_ = true;
    boost::asio::post(socket_.get_executor(),
                      [self = shared_from_this()] { self->give_up(line_fault::unread); });
}

void line_connection::write()
{
    std::vector<boost::asio::const_buffer> buffers;
    for (std::size_t i = 0; i < std::min(queue_.size(), lines_at_once); ++i)
        buffers.push_back(boost::asio::buffer(queue_[i]));
    in_flight_ = buffers.size();
    boost::asio::async_write(socket_, buffers,
                             [self = shared_from_this()](const boost::system::error_code& e, std::size_t n) {
                                 if (self->closed_)
                                     return;
                                 if (e)
                                     self->give_up(line_fault::gone);
                                 else
                                     self->wrote(n);
                             });
}

void line_connection::wrote(std::size_t n)
{
    share_.take(n);
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(in_flight_));
    in_flight_ = 0;
    if (!queue_.empty())
        write();
    else if (finishing_)
        close();
}

void line_connection::finish()
{
    if (closed_)
        return;
    reading_ = false;
    finishing_ = true;
    deadline_.cancel();
    if (queue_.empty())
        return close();
    linger_.expires_after(linger);
    linger_.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        if (!e)
            self->close();
    });
}

void line_connection::close()
{
    if (closed_)
        return;
    const auto self = shared_from_this();
    closed_ = true;
    reading_ = false;
    deadline_.cancel();
    linger_.cancel();
    boost::system::error_code ignored;
    // What the peer sent and nobody read would turn our last words into a reset.
    socket_.shutdown(boost::asio::socket_base::shutdown_send, ignored);
    for (std::size_t drained = 0; drained < (1U << 20) && socket_.available(ignored) != 0 && !ignored;)
        drained += socket_.read_some(boost::asio::buffer(chunk_), ignored);
    socket_.close(ignored);
    if (handlers_.closed)
        boost::asio::post(deadline_.get_executor(), [self] {
            const auto h = std::exchange(self->handlers_, {});
            h.closed();
        });
}

} // namespace tactor::net
