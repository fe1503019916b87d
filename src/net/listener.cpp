// SPDX-License-Identifier: MIT
#include "net/listener.hpp"

#include <cerrno>
#include <chrono>
#include <new>
#include <utility>

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace tactor::net {
namespace {

namespace asio = boost::asio;

constexpr auto accept_pause = std::chrono::milliseconds(100);

} // namespace

listener::listener(asio::io_context& io, int fd, std::string when_full,
                   std::function<void(socket_type)> taken)
    : io_(io), fd_(io, fd), pause_(io), when_full_(std::move(when_full)), taken_(std::move(taken))
{
    keep_spare();
}

listener::~listener()
{
    fd_.release();
}

void listener::keep_spare() noexcept
{
    if (!spare_)
        spare_ = detail::owned_fd(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

void listener::start()
{
    fd_.async_wait(asio::posix::descriptor_base::wait_read, [this](const boost::system::error_code& e) {
        if (e)
            return;
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
            } catch (const std::bad_alloc&) { // NOLINT(bugprone-empty-catch): the socket closes, others stay
            }
        return start();
    }
    if (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED)
        return start();
    if ((errno == EMFILE || errno == ENFILE) && turn_away())
        return start();
    // Memory ran out, or another process took the spare descriptor. An attempt without a pause would only
    // take time.
    pause_.expires_after(accept_pause);
    pause_.async_wait([this](const boost::system::error_code& e) {
        if (!e)
            start();
    });
}

// Accepts on the spare descriptor, sends the refusal as far as the socket takes it, and closes.
bool listener::turn_away() noexcept
{
    keep_spare();
    if (!spare_)
        return false;
    spare_.close();
    detail::owned_fd next(::accept4(fd_.native_handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    const bool came = static_cast<bool>(next);
    if (came)
        static_cast<void>(
            ::send(next.get(), when_full_.data(), when_full_.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
    next.close();
    keep_spare();
    return came;
}

} // namespace tactor::net
