// SPDX-License-Identifier: MIT
/// \file
/// OSC over UDP: a socket for all senders.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "net/access.hpp"
#include "server/osc/clients.hpp"

namespace tactor::server {

class osc_endpoint {
public:
    static constexpr std::size_t largest_packet = 65536;

    /// Uses `fd`, a bound socket, which stays its owner's. Accepts only `peers` of other machines.
    osc_endpoint(boost::asio::io_context& io, int fd, service& s, std::vector<net::address_prefix> peers,
                 std::size_t most_bytes);
    ~osc_endpoint();
    osc_endpoint(const osc_endpoint&) = delete;
    osc_endpoint& operator=(const osc_endpoint&) = delete;

    void start();
    /// Stops receiving; known senders still get the ends of their strokes.
    void stop();

private:
    void take();
    void arm();
    void send(const osc_clients::endpoint& to, const std::string& packet);

    boost::asio::ip::udp::socket socket_;
    boost::asio::steady_timer due_;
    std::vector<net::address_prefix> peers_;
    osc_clients clients_;
    std::array<char, largest_packet> packet_{};
};

} // namespace tactor::server
