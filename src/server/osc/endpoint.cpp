// SPDX-License-Identifier: MIT
#include "server/osc/endpoint.hpp"

#include <chrono>
#include <new>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <sys/socket.h>

namespace tactor::server {
namespace {

namespace asio = boost::asio;
using udp = asio::ip::udp;

udp find_protocol(int fd)
{
    sockaddr_storage at{};
    socklen_t size = sizeof at;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as sockets want it
    const bool known = ::getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size) == 0;
    return known && at.ss_family == AF_INET6 ? udp::v6() : udp::v4();
}

std::int64_t monotonic_ns()
{
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

} // namespace

osc_endpoint::osc_endpoint(asio::io_context& io, int fd, service& s, std::vector<net::address_prefix> peers,
                           std::size_t most_bytes)
    : socket_(io, find_protocol(fd), fd),
      due_(io),
      peers_(std::move(peers)),
      clients_(io, s,
               {[this](const osc_clients::endpoint& to, const std::string& packet) { send(to, packet); },
                monotonic_ns, unix_ns, most_bytes})
{
    socket_.non_blocking(true);
}

osc_endpoint::~osc_endpoint()
{
    boost::system::error_code ignored;
    socket_.release(ignored);
}

void osc_endpoint::start()
{
    socket_.async_wait(udp::socket::wait_read, [this](const boost::system::error_code& e) {
        if (e)
            return;
        take();
        start();
    });
}

void osc_endpoint::stop()
{
    boost::system::error_code ignored;
    socket_.cancel(ignored);
    due_.cancel();
    clients_.drop_held();
}

// Handles one packet, then lets others have their turn.
void osc_endpoint::take()
{
    boost::system::error_code failed;
    udp::endpoint from;
    const std::size_t n = socket_.receive_from(asio::buffer(packet_), from, 0, failed);
    if (!failed && net::is_accepted(from.address(), peers_))
        try {
            clients_.receive({packet_.data(), n}, from);
        } catch (const std::bad_alloc&) { // NOLINT(bugprone-empty-catch): lost, as it may be on its way
        }
    arm();
}

void osc_endpoint::arm()
{
    const auto next = clients_.next_ns();
    if (!next)
        return static_cast<void>(due_.cancel());
    due_.expires_at(std::chrono::steady_clock::time_point(std::chrono::nanoseconds(*next)));
    due_.async_wait([this](const boost::system::error_code& e) {
        if (e)
            return;
        clients_.act();
        arm();
    });
}

// Sends a datagram. It is lost if the system has no space, as it may be on its way.
void osc_endpoint::send(const osc_clients::endpoint& to, const std::string& packet)
{
    boost::system::error_code lost;
    socket_.send_to(asio::buffer(packet), to, 0, lost);
}

} // namespace tactor::server
