// SPDX-License-Identifier: MIT
/// \file
/// Accepts connections.
#pragma once

#include <functional>
#include <string>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/owned.hpp"

namespace tactor::net {

/// A listening socket that accepts connections one after the other. When no descriptors are left, it accepts
/// a client on a spare one, sends a refusal and closes.
class listener {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    /// Listens on `fd`, which stays its owner's. `when_full`: refusal when descriptors run out.
    listener(boost::asio::io_context& io, int fd, std::string when_full,
             std::function<void(socket_type)> taken);
    ~listener();
    listener(const listener&) = delete;
    listener& operator=(const listener&) = delete;

    void start();
    void stop();

private:
    void take();
    bool turn_away() noexcept;
    void keep_spare() noexcept;

    boost::asio::io_context& io_;
    boost::asio::posix::stream_descriptor fd_;
    boost::asio::steady_timer pause_;
    std::string when_full_;
    std::function<void(socket_type)> taken_;
    detail::owned_fd spare_;
};

} // namespace tactor::net
