// SPDX-License-Identifier: MIT
#include "net/connection.hpp"

#include <utility>

#include <boost/asio/post.hpp>

namespace tactor::net {
namespace {

constexpr std::chrono::seconds linger{1};

// Large messages of a peer that wait. It is not read any further with so many.
constexpr unsigned most_large = 4;

} // namespace

connection::connection(const boost::asio::any_io_executor& executor, const message_limits& l)
    : limits_(l), deadline_(executor), linger_(executor)
{
}

void connection::start(peer_handlers h)
{
    handlers_ = std::move(h);
    arm(limits_.message_s);
    read_first();
}

void connection::handle(std::string_view text)
{
    const auto self = shared_from_this();
    if (text.empty())
        return read();
    if (handled(handlers_.message(text)))
        read();
}

void connection::handle_large(std::vector<std::string> parts)
{
    ++large_;
    handlers_.large(std::move(parts), [self = shared_from_this()](bool go_on) {
        const bool waited = self->large_-- == most_large;
        if (self->handled(go_on) && waited)
            self->read();
    });
    if (large_ < most_large)
        read();
}

// Returns true if more is to be read.
bool connection::handled(bool go_on)
{
    if (closed_ || finishing_)
        return false;
    if (!go_on)
        turn_out("this is not taken");
    if (reading_ && !met_ && (!handlers_.met || handlers_.met())) {
        met_ = true;
        disarm();
    }
    return reading_;
}

void connection::message_begins()
{
    if (!armed_)
        arm(limits_.message_s);
}

void connection::message_ends()
{
    if (met_)
        disarm();
}

void connection::arm(double seconds)
{
    armed_ = true;
    deadline_.expires_after(steady_seconds(seconds));
    deadline_.async_wait([self = shared_from_this()](const boost::system::error_code& e) {
        // The timer may have been set again while this was queued.
        if (!e && self->armed_ && !self->closed_ &&
            self->deadline_.expiry() <= boost::asio::steady_timer::clock_type::now())
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
        // Does not close here, because the caller may be iterating over all peers.
        return boost::asio::post(executor(), [self = shared_from_this()] { self->close(); });
    }
    if (file)
        ++files_;
    else
        waiting_ += message.size();
    queue_.push_back({std::move(message), file});
    if (!writing_ && may_write_)
        write_on();
}

void connection::write_on()
{
    if (queue_.empty()) {
        if (finishing_)
            say_farewell();
        return;
    }
    writing_ = true;
    write();
}

void connection::wrote(std::size_t messages)
{
    writing_ = false;
    if (closed_)
        return;
    for (; messages != 0; --messages) {
        const outgoing& first = queue_.front();
        if (first.file)
            --files_;
        else
            waiting_ -= first.text.size();
        queue_.pop_front();
    }
    write_on();
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
    turn_out(f == connection_fault::memory ? "there is not enough memory for it"
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
    hang_up_soon();
    if (!writing_ && may_write_)
        write_on();
}

void connection::hang_up_soon()
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
    shut();
    if (handlers_.closed)
        boost::asio::post(executor(), [self] {
            const auto h = std::exchange(self->handlers_, {});
            h.closed();
        });
}

} // namespace tactor::net
