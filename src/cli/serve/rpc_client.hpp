// SPDX-License-Identifier: MIT
/// \file
/// A client of `tactor serve` that waits for its answers.
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>

#include <tactor/error.hpp>

#include "net/listen.hpp"
#include "net/rpc.hpp"
#include "session/interrupt.hpp"

namespace tactor::cli {

/// A signal has come. The exit status: interrupt::status().
struct interrupted {
    int signal;
};

/// Of a server: the one that was named, else XDG_RUNTIME_DIR's, else the system's.
/// \throws error (not_available) where none listens.
class rpc_client {
public:
    /// A signal at `stop` ends what waits for a reply.
    rpc_client(const std::optional<std::string>& socket, session::interrupt& stop);

    /// The result. \throws error with the server's words, runtime where it went away; interrupted.
    net::json call(const std::string& method, const net::json& params = net::json::object());
    /// As call(), but false where a limit of the server's is reached: to be tried again.
    bool try_call(const std::string& method, const net::json& params);
    /// Without a reply.
    void tell(const std::string& method, const net::json& params);

    /// The next notification that has come. Does not wait.
    std::optional<net::json> notification();
    /// Waits until something has come from the server or at `also`, or a signal. \throws interrupted.
    void wait(int also = -1);
    /// From now on a first signal is only told by signal(), and the server has so long for what is asked of
    /// it then. Where it comes while a reply is awaited, the server is told to cancel all that this client
    /// asked for: also what it is still planning, and would play though nobody were left to cancel it.
    void let_finish(std::chrono::milliseconds grace) { grace_ = grace; }
    /// That has come, or 0.
    int signal() const noexcept { return signal_; }
    const std::string& socket() const noexcept { return path_; }

private:
    void send(const net::json& message);
    /// The reply to it, or an error that answers nothing.
    net::json answer(const std::string& method, const net::json& params);
    /// Whether the socket can be read or written (POLLIN, POLLOUT); waits for that, `also`, or a signal.
    bool poll(short what, int also);
    /// Takes in what is there; waits for something where there is nothing.
    void receive();
    std::optional<net::json> message();

    session::interrupt& stop_;
    net::owned_fd fd_;
    std::string path_;
    std::string buffer_;
    std::deque<net::json> told_;
    int last_ = 0;
    int signal_ = 0;
    bool cancelled_ = false;
    std::chrono::milliseconds grace_{0};
    std::chrono::steady_clock::time_point deadline_ = {};
};

} // namespace tactor::cli
