// SPDX-License-Identifier: MIT
/// \file
/// What clients of streams are sent, and told before they are given up.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "net/line_connection.hpp"
#include "server/service.hpp"

namespace tactor::server {

/// A client's way back over a connection of either kind.
template <class Connection>
class link_over final : public client_link {
public:
    explicit link_over(std::shared_ptr<Connection> c) : connection_(std::move(c)) {}
    void send(std::string message) override { connection_->send(std::move(message)); }
    std::size_t waiting() const override { return connection_->waiting(); }
    void finish() override { connection_->finish(); }
    void turn_out(const char* why) override
    {
        if constexpr (requires { connection_->turn_out(why); })
            connection_->turn_out(why);
        else
            connection_->finish(); // the last reply has said it
    }

private:
    std::shared_ptr<Connection> connection_;
};

/// An error of -32001 that answers nothing.
std::string refusal(std::string what, std::string why, std::string hint);

/// What those are told for whom no descriptor is left, with the line's end.
std::string no_descriptors();

/// What a client is told; empty for one that can be told nothing. `admitted`: no token of it is owed.
std::string why_given_up(net::line_fault f, const service_limits& l, bool admitted);

} // namespace tactor::server
