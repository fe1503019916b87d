// SPDX-License-Identifier: MIT
/// \file
/// A client of `tactor serve` whose calls wait for the answers.
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

/// Exception for a signal. The exit status is interrupt::status().
struct interrupted {
    int signal;
};

/// An error from a server, with the server's texts.
struct server_error : error {
    server_error(const error& e, int code, std::string what)
        : error(e), rpc_code(code), param(std::move(what))
    {
    }

    int rpc_code;      ///< error code, such as net::code_no_stroke
    std::string param; ///< wrong parameter of the request
};

/// Client of a server.
class rpc_client {
public:
    /// Connects to the given socket. If none is given, tries the socket in XDG_RUNTIME_DIR, then that of the
    /// system service. A signal at `stop` interrupts waiting for a reply. \throws error (not_available) if no
    /// server listens.
    rpc_client(const std::optional<std::string>& socket, session::interrupt& stop);

    /// Calls a method and returns its result. \throws server_error; error (runtime) if the connection is
    /// lost; interrupted.
    net::json call(const std::string& method, const net::json& params = net::json::object());
    /// Calls a method. Returns false if a limit of the server is reached; then try again. \throws as call()
    /// does.
    bool try_call(const std::string& method, const net::json& params);
    /// Sends a notification. The server does not reply.
    void send_notification(const std::string& method, const net::json& params);

    /// Returns the next notification if one has arrived. Does not wait.
    std::optional<net::json> notification();
    /// Waits until the server or the descriptor `also` has input, or a signal arrives. \throws interrupted.
    void wait(int also = -1);
    /// Gives the server time to finish after a first signal. From now on such a signal only sets signal(). If
    /// it arrives while a call waits for its reply, this client tells the server to cancel all its requests,
    /// including those that the server is still planning. Otherwise nobody could cancel their strokes.
    void set_grace_period(std::chrono::milliseconds grace) { grace_ = grace; }
    /// Returns the signal that has arrived, or 0.
    int signal() const noexcept { return signal_; }
    const std::string& socket() const noexcept { return path_; }

private:
    void send(const net::json& message);
    /// Sends a request. Returns the reply to it, or an error reply without a request id.
    net::json answer(const std::string& method, const net::json& params);
    /// Waits until the socket is ready for `what` (POLLIN, POLLOUT), `also` has input, or a signal arrives.
    /// Returns true if the socket is ready.
    bool poll(short what, int also);
    /// Receives the available input. If there is none, waits for input.
    void receive();
    /// Returns the next complete message from the received input, if any.
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
