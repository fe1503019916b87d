// SPDX-License-Identifier: MIT
#include "net/line_connection.hpp"

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>

namespace tactor::net {
namespace {

constexpr std::size_t chunk_bytes = 16U << 10;
constexpr std::size_t most_block_bytes = 128U << 10; // of a line that is large
constexpr std::size_t most_drained = 128U << 10;
constexpr std::size_t lines_at_once = 16;
constexpr char line_end = '\n';

} // namespace

line_connection::line_connection(socket_type s, const message_limits& l)
    : connection(s.get_executor(), l), socket_(std::move(s)), chunk_(chunk_bytes)
{
}

// Handles one line at a time, so that other peers have their turn between two.
void line_connection::read()
{
    if (!reads())
        return;
    scanned_ = std::min(text_.find(line_end, scanned_), text_.size());
    if (scanned_ == text_.size())
        return read_more();
    boost::asio::post(executor(), [this, self = shared_from_this()] { within_memory([&] { next_line(); }); });
}

void line_connection::next_line()
{
    if (!reads())
        return;
    std::size_t size = block_bytes_ + scanned_ - begin_;
    const std::size_t begin = std::exchange(begin_, ++scanned_);
    const char last = scanned_ - begin > 1 ? text_[scanned_ - 2]
                      : blocks_.empty()    ? '\0'
                                           : blocks_.back().back();
    const bool has_return = last == '\r';
    size -= has_return ? 1 : 0;
    if (size > limits().message_bytes)
        return fail(connection_fault::too_long);
    message_ends();
    if (size <= large_message)
        return handle({text_.data() + begin, size});
    std::vector<std::string> parts = std::exchange(blocks_, {});
    parts.push_back(text_.substr(begin, scanned_ - 1 - begin));
    block_bytes_ = 0;
    if (has_return) // which may be all of the last part
        (parts.back().empty() ? parts[parts.size() - 2] : parts.back()).pop_back();
    handle_large(std::move(parts));
}

void line_connection::read_more()
{
    text_.erase(0, std::exchange(begin_, 0));
    const bool may_end = text_.ends_with('\r');
    if (block_bytes_ + text_.size() > limits().message_bytes + (may_end ? 1 : 0))
        return fail(connection_fault::too_long);
    // Keeps blocks: one string would be copied as it grows, and all peers' may grow in one turn.
    if (text_.size() + chunk_bytes > most_block_bytes) {
        block_bytes_ += text_.size();
        blocks_.push_back(std::exchange(text_, {}));
    }
    if (text_.empty())
        std::string().swap(text_); // returns its memory
    scanned_ = text_.size();
    if (over_) {
        stop_reading();
        watch();
        return calls().input_ended();
    }
    if (block_bytes_ + text_.size() != 0)
        message_begins();
    socket_.async_read_some(
        boost::asio::buffer(chunk_),
        [this, self = shared_from_this()](const boost::system::error_code& e, std::size_t n) {
            if (closed() || e == boost::asio::error::operation_aborted)
                return;
            if (e && e != boost::asio::error::eof)
                return fail(connection_fault::gone);
            within_memory([&] {
                if (e)
                    all_read();
                else
                    text_.append(chunk_.data(), n);
                read();
            });
        });
}

// Handles the end of the input, which also ends a line: an incomplete one is no JSON, so the peer gets an
// error.
void line_connection::all_read()
{
    over_ = true;
    if (block_bytes_ + text_.size() != 0)
        text_ += line_end;
}

// Notices that the other end is gone. A Unix socket reports it when the peer closes, TCP when we write.
void line_connection::watch()
{
    socket_.async_wait(socket_type::wait_error,
                       [this, self = shared_from_this()](const boost::system::error_code& e) {
                           if (!e)
                               fail(connection_fault::gone);
                       });
}

void line_connection::write()
{
    const std::size_t lines = std::min(queued().size(), lines_at_once);
    std::vector<boost::asio::const_buffer> buffers;
    for (std::size_t i = 0; i < lines; ++i) {
        buffers.push_back(boost::asio::buffer(queued()[i].text));
        buffers.push_back(boost::asio::buffer(&line_end, 1));
    }
    boost::asio::async_write(
        socket_, buffers,
        [this, self = shared_from_this(), lines](const boost::system::error_code& e, std::size_t) {
            if (e)
                fail(connection_fault::gone);
            else
                wrote(lines);
        });
}

void line_connection::shut()
{
    boost::system::error_code ignored;
    // Reads what is left: unread input would turn the last message into a reset.
    socket_.shutdown(boost::asio::socket_base::shutdown_send, ignored);
    for (std::size_t drained = 0; drained < most_drained && socket_.available(ignored) != 0 && !ignored;)
        drained += socket_.read_some(boost::asio::buffer(chunk_), ignored);
    socket_.close(ignored);
}

} // namespace tactor::net
