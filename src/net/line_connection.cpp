// SPDX-License-Identifier: MIT
#include "net/line_connection.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>

namespace tactor::net {
namespace {

constexpr std::size_t chunk_bytes = 16U << 10;
constexpr std::size_t block_bytes = 128U << 10;
constexpr std::size_t lines_at_once = 16;
constexpr std::chrono::seconds linger{1};

} // namespace

line_connection::line_connection(socket_type s, const line_limits& l, shared_by_peers& all)
    : socket_(std::move(s)),
      limits_(l),
      unread_(all.unread, [this] { give_up_soon(line_fault::unread); }),
      unfinished_(all.unfinished, [this] { give_up_soon(line_fault::crowded); }),
      turns_(all.turns),
      small_(all.small),
      deadline_(socket_.get_executor()),
      linger_(socket_.get_executor()),
      chunk_(chunk_bytes)
{
}

void line_connection::start(peer_handlers h)
{
    handlers_ = std::move(h);
    arm(limits_.message_s);
    read();
}

// Closes this connection if its input needs more memory than there is; the others stay.
template <typename F>
void line_connection::within_memory(F f)
{
    const auto self = shared_from_this();
    try {
        f();
    } catch (const std::bad_alloc&) {
        give_up(line_fault::memory);
    }
}

void line_connection::read()
{
    if (!reading_ || closed_)
        return;
    socket_.async_read_some(boost::asio::buffer(chunk_),
                            [self = shared_from_this()](const boost::system::error_code& e, std::size_t n) {
                                if (self->closed_ || e == boost::asio::error::operation_aborted)
                                    return;
                                if (!e)
                                    self->within_memory([&] { self->received(n); });
                                else if (e == boost::asio::error::eof)
                                    self->within_memory([&] { self->all_read(); });
                                else
                                    self->give_up(line_fault::gone);
                            });
}

// Notices that the other end is gone. A Unix socket reports it when the peer closes, TCP when we write.
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
    if (hold())
        next_line();
}

bool line_connection::hold()
{
    return unfinished_.hold(partial_.capacity() + blocks_.size() * block_bytes);
}

// Handles the end of the input, which also ends a line: an incomplete one is no JSON, so the peer gets an
// error.
void line_connection::all_read()
{
    if (!reading_)
        return;
    over_ = true;
    if (partial_.size() != begin_ || !blocks_.empty())
        partial_ += '\n';
    next_line();
}

// Handles one line, then gives others their turn.
void line_connection::next_line()
{
    if (closed_ || !reading_)
        return;
    const std::size_t end = partial_.find('\n', std::max(begin_, scanned_));
    if (end == std::string::npos)
        return no_line();
    std::size_t size = end - begin_;
    for (const std::string& b : blocks_)
        size += b.size();
    if (size != 0 && (end != begin_ ? partial_[end - 1] : blocks_.back().back()) == '\r')
        --size;
    scanned_ = end;
    if (size > limits_.message_bytes)
        return give_up(line_fault::too_long);
    if (met_) {
        armed_ = false;
        deadline_.cancel();
    }
    if (size == 0 || is_urgent(size))
        return handle_line(size);
    if (size <= small_message || !handlers_.large)
        return small_.join([self = shared_from_this(), size] {
            if (!self->closed_ && self->reading_)
                self->within_memory([&] { self->handle_line(size); });
        });
    turns_.join([self = shared_from_this(), size] { self->handle_large(size); });
}

bool line_connection::is_urgent(std::size_t size) const
{
    return size <= small_message && blocks_.empty() && handlers_.urgent &&
           handlers_.urgent({partial_.data() + begin_, size});
}

void line_connection::handle_line(std::size_t size)
{
    const auto self = shared_from_this();
    const std::string large = blocks_.empty() ? std::string() : whole_line(size);
    const std::string_view line =
        blocks_.empty() ? std::string_view(partial_.data() + begin_, size) : std::string_view(large);
    handled(size, size == 0 || handlers_.message(line));
}

std::string line_connection::whole_line(std::size_t size)
{
    std::string all;
    all.reserve(size + 1);
    for (const std::string& b : blocks_)
        all += b;
    all.append(partial_, begin_, size + 1 - all.size());
    all.resize(size);
    return all;
}

void line_connection::handle_large(std::size_t size)
{
    if (closed_ || !reading_)
        return turns_.pass();
    const auto done = [self = shared_from_this(), size](bool go_on) {
        self->turns_.pass();
        if (!self->closed_)
            self->within_memory([&] { self->handled(size, go_on); });
    };
    try {
        handlers_.large(whole_line(size), done);
    } catch (const std::bad_alloc&) {
        turns_.pass();
        give_up(line_fault::memory);
    }
}

void line_connection::handled(std::size_t size, bool go_on)
{
    if (closed_)
        return;
    if (!go_on)
        return finish();
    if (!reading_)
        return;
    blocks_.clear();
    begin_ = scanned_ = partial_.find('\n', scanned_) + 1;
    met_ = met_ || (size != 0 && (!handlers_.met || handlers_.met()));
    if (met_) {
        armed_ = false;
        deadline_.cancel();
    }
    if (partial_.find('\n', begin_) == std::string::npos)
        return next_line();
    boost::asio::post(socket_.get_executor(),
                      [self = shared_from_this()] { self->within_memory([&] { self->next_line(); }); });
}

// Keeps the start of a line, if any.
void line_connection::no_line()
{
    partial_.erase(0, std::exchange(begin_, 0));
    if (blocks_.empty() && partial_.empty())
        std::string().swap(partial_); // returns its memory
    std::size_t size = partial_.size();
    for (const std::string& b : blocks_)
        size += b.size();
    const bool may_end = !partial_.empty() && partial_.back() == '\r';
    // Stores blocks instead of one string that is copied as it grows: all peers' may grow in one turn.
    if (partial_.size() + chunk_bytes > block_bytes)
        blocks_.push_back(std::exchange(partial_, {}));
    scanned_ = partial_.size();
    if (!hold())
        return;
    if (size > limits_.message_bytes + (may_end ? 1 : 0))
        return give_up(line_fault::too_long);
    if (over_) {
        reading_ = false;
        deadline_.cancel();
        watch();
        return handlers_.input_ended();
    }
    if (size != 0 && !armed_)
        arm(limits_.message_s);
    read();
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
    drop_unfinished();
    if (handlers_.fault)
        handlers_.fault(f);
    if (f != line_fault::unread && f != line_fault::gone)
        finish();
    else
        close();
}

void line_connection::queue(std::string line, bool large)
{
    if (closed_ || finishing_)
        return;
    line += '\n';
    const std::size_t n = line.size();
    if (!large && unread_.held() - large_bytes_ + n > limits_.waiting_bytes)
        unread_.give_up();
    if (!unread_.add(n))
        return;
    large_bytes_ += large ? n : 0;
    queue_.push_back({std::move(line), large});
    if (in_flight_ == 0)
        write();
}

// Does not close here, because the caller may be iterating over all peers.
void line_connection::drop_unfinished()
{
    blocks_ = {};
    std::string().swap(partial_);
    begin_ = scanned_ = 0;
    unfinished_.take(unfinished_.held());
}

void line_connection::give_up_soon(line_fault f)
{
    if (f == line_fault::crowded)
        drop_unfinished();
    finishing_ = finishing_ || f == line_fault::unread;
    reading_ = reading_ && f == line_fault::unread;
    boost::asio::post(socket_.get_executor(), [self = shared_from_this(), f] { self->give_up(f); });
}

void line_connection::write()
{
    std::vector<boost::asio::const_buffer> buffers;
    for (std::size_t i = 0; i < std::min(queue_.size(), lines_at_once); ++i)
        buffers.push_back(boost::asio::buffer(queue_[i].text));
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
    unread_.take(n);
    for (std::size_t i = 0; i < in_flight_; ++i)
        large_bytes_ -= queue_[i].large ? queue_[i].text.size() : 0;
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
    // Reads what is left: unread input would turn the last message into a reset.
    socket_.shutdown(boost::asio::socket_base::shutdown_send, ignored);
    for (std::size_t drained = 0; drained < block_bytes && socket_.available(ignored) != 0 && !ignored;)
        drained += socket_.read_some(boost::asio::buffer(chunk_), ignored);
    socket_.close(ignored);
    if (handlers_.closed)
        boost::asio::post(deadline_.get_executor(), [self] {
            const auto h = std::exchange(self->handlers_, {});
            h.closed();
        });
}

} // namespace tactor::net
