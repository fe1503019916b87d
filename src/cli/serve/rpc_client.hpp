// SPDX-License-Identifier: MIT
/// \file
/// A client of `tactor serve` that waits for its answers.
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include <tactor/error.hpp>

#include "net/listen.hpp"
#include "net/rpc.hpp"
#include "session/process.hpp"

namespace tactor::cli {

/// Thrown when a signal comes. The exit status is interrupt::status().
struct interrupted {
    int signal;
};

/// Error that a server answered, in its words.
struct server_error : error {
    server_error(const error& e, int code, std::string what)
        : error(e), rpc_code(code), param(std::move(what))
    {
    }

    int rpc_code;      ///< such as net::code_no_stroke
    std::string param; ///< parameter of the request that is at fault
};

/// Client of a server.
class rpc_client {
public:
    /// Connects to the named server, else to that of XDG_RUNTIME_DIR, else to the system's. A signal at
    /// `stop` interrupts waiting for a reply. \throws error (not_available) if none listens.
    rpc_client(const std::optional<std::string>& socket, session::interrupt& stop);

    /// Returns the result. \throws server_error; error (runtime) if the server went away; interrupted.
    net::json call(const std::string& method, const net::json& params = net::json::object());
    /// Does the same. Returns false if a limit of the server is reached: try again.
    bool try_call(const std::string& method, const net::json& params);
    /// Sends a notification, which has no reply.
    void tell(const std::string& method, const net::json& params);

    /// Returns the next notification, if any. Does not wait.
    std::optional<net::json> notification();
    /// Waits until the server or `also` has input, or a signal comes. \throws interrupted.
    void wait(int also = -1);
    /// Gives the server time to finish after a first signal, which from now on only sets signal(). If the
    /// signal comes while a call waits for its reply, tells the server to cancel all requests of this client.
    /// That includes requests that it is still planning: nobody could cancel their strokes later.
    void let_finish(std::chrono::milliseconds grace) { grace_ = grace; }
    /// Returns the signal that came, or 0.
    int signal() const noexcept { return signal_; }
    const std::string& socket() const noexcept { return path_; }

private:
    void send(const net::json& message);
    /// Sends a request. Returns its reply, or an error that answers no request.
    net::json answer(const std::string& method, const net::json& params);
    /// Waits for the socket (POLLIN, POLLOUT), `also`, or a signal. Returns true if the socket is ready.
    bool poll(short what, int also);
    /// Receives the available input; waits for some if there is none.
    void receive();
    /// Returns the next whole message that was received.
    std::optional<net::json> message();

    session::interrupt& stop_;
    net::owned_fd fd_;
    std::string path_;
    std::string buffer_;
    std::deque<net::json> notifications_;
    int last_ = 0;
    int signal_ = 0;
    bool cancelled_ = false;
    std::chrono::milliseconds grace_{0};
    std::chrono::steady_clock::time_point deadline_ = {};
};

} // namespace tactor::cli
