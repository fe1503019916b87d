// SPDX-License-Identifier: MIT
/// \file
/// A client of `tactor serve` that waits for its answers.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <string>

#include <tactor/error.hpp>

#include "net/listen.hpp"
#include "net/rpc.hpp"

namespace tactor::cli {

/// Of a server: the one that was named, else XDG_RUNTIME_DIR's, else the system's.
/// \throws error (not_available) where none listens.
class rpc_client {
public:
    explicit rpc_client(const std::optional<std::string>& socket);

    /// The result. \throws error with the server's words; runtime where it went away.
    net::json call(const std::string& method, const net::json& params = net::json::object());
    /// Without a reply.
    void tell(const std::string& method, const net::json& params);

    /// The next notification that has come. Does not wait.
    std::optional<net::json> notification();
    /// Readable when something has come.
    int descriptor() const noexcept { return fd_.get(); }
    const std::string& socket() const noexcept { return path_; }

private:
    void send(const net::json& message);
    /// Takes in what is there; waits for something where there is nothing.
    void receive();
    std::optional<net::json> message();

    net::owned_fd fd_;
    std::string path_;
    std::string buffer_;
    std::deque<net::json> told_;
    int last_ = 0;
};

} // namespace tactor::cli
