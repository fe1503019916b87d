// SPDX-License-Identifier: MIT
/// \file
/// The clients of the service: how many there may be, their tokens, limits and subscriptions.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "net/connection.hpp"
#include "net/rpc.hpp"
#include "server/planners.hpp"
#include "server/request.hpp"
#include "server/stream.hpp"

namespace tactor::server {

struct service_options;

/// Number of unsent bytes from which a client counts as slow. While it is slow, it gets no notifications of
/// levels, touches and stops.
inline constexpr std::size_t enough_waiting = 64U << 10;

/// A rate limit. It allows a number of actions at once, and allows this number again after one second.
struct allowance {
    double remaining = std::numeric_limits<double>::infinity();
    std::int64_t at_ns = 0;

    /// Takes `n` actions from the allowance of `per_s` actions per second. Returns false, and takes none, if
    /// fewer than `n` remain.
    bool take(double n, double per_s, std::int64_t now_ns) noexcept
    {
        remaining = std::min(per_s, remaining + seconds(now_ns - std::exchange(at_ns, now_ns)) * per_s);
        if (remaining < n)
            return false;
        remaining -= n;
        return true;
    }
};

/// Connection to a client. Its finish() must not call the service directly, because the service may be in the
/// middle of another call.
using client_link = net::peer;

/// Kind of connection of a client.
enum class client_kind {
    local,
    network,
    web,
    datagram,
    bhaptics, ///< a program whose protocol has no token
};

/// A client, and counts of its requests.
struct client {
    client_number number;
    std::shared_ptr<client_link> link;
    client_kind kind;
    std::string from;      ///< address, in the form that other clients see
    std::string name = {}; ///< name that the client chose
    bool greeted = false;  ///< false if a network client has not yet sent hello
    bool admitted = false; ///< true if its token was right, or if it needs none
    bool input_over = false;
    unsigned wrong_tokens = 0;
    unsigned refusals_waiting = 0; ///< answers to wrong tokens that are delayed and not yet sent
    std::set<std::string> events = {};
    double levels_hz = 30.0;
    boost::asio::steady_timer levels_timer;
    std::vector<float> levels = {}; ///< peaks by channel since the last notification
    std::size_t coming = 0;         ///< requests whose strokes have no numbers yet
    std::size_t bytes = 0;          ///< bytes of requests that wait for planning
    std::size_t unanswered = 0;
    std::set<std::uint32_t> strokes = {}; ///< strokes that have not ended yet
    std::size_t live = 0;
    /// Number of times that the client has cancelled all its strokes. Requests of the client share this
    /// counter, because they may outlive the client.
    std::shared_ptr<std::uint64_t> cancels = std::make_shared<std::uint64_t>(0);
    allowance points = {}; ///< number of points that the client may send now
    double level_db = 0.0; ///< level of the client's strokes, relative to the strokes' own

    /// Returns true if the client is subscribed to an event and is not slow.
    bool hears(const std::string& event) const
    {
        return events.contains(event) && link->queued_bytes() < enough_waiting;
    }
};

/// Clients of a service. Call its members in the context's thread.
class client_list {
public:
    /// Constructs an empty list. The options and the level meter must outlive it.
    client_list(boost::asio::io_context& io, const service_options& o, level_peaks& peaks)
        : io_(io), options_(o), peaks_(peaks)
    {
    }

    /// Returns the number of clients below which another client of this kind is accepted.
    std::size_t places(client_kind k) const noexcept;
    /// Returns true if a client of this kind can be accepted.
    bool has_free_place(client_kind k) const;
    client& add(std::shared_ptr<client_link> link, client_kind k, std::string from);
    /// Returns the client with a number, or null if it has disconnected.
    client* find(client_number number) const;
    /// Removes a client. References to the client's counts stay valid until the result is destroyed.
    std::unique_ptr<client> remove(client_number number);
    const std::map<client_number, std::unique_ptr<client>>& all() const noexcept { return all_; }

    /// Sets a handler. It is called when a client that has closed its sending side has received all its
    /// messages.
    void on_all_sent(std::function<void(client_number)> f) { all_sent_ = std::move(f); }
    /// Calls the handler of on_all_sent() if a client meets the condition. Returns true if the client meets
    /// the condition or has disconnected.
    bool check_all_sent(client_number number);
    /// Disconnects the first client that has closed its sending side if there are more than max_clients such
    /// clients.
    void limit_silent_clients();

    /// Returns true if the client is connected and does not need to send a token.
    bool is_admitted(client_number number) const;
    /// Returns true if a token is right, or if the service needs no token.
    bool accepts_token(std::string_view token) const;
    /// Returns true if a client has been admitted, needs no token, or sends the right token. Otherwise calls
    /// `refuse`: immediately if there is no token (null), and after a delay if the token is wrong. Closes the
    /// connection after the third missing or wrong token.
    bool admit(client& c, const std::string* token, std::function<void()> refuse);
    /// Counts and logs a wrong token from an address. Returns the delay of the answer, s. It grows with the
    /// number of wrong tokens from this address.
    double count_wrong_token(const std::string& from);
    /// Logs the refusal of a connection or a message. `from` is the address of the sender, or "" for this
    /// computer. Writes at most about ten lines per second.
    void log_refusal(const std::string& from, std::string_view why);

    /// Sets the events that a client is notified of, and the rate of its level notifications.
    void subscribe(client& c, std::set<std::string> events, double levels_hz);
    /// Moves the peaks of the level meter into the levels of the clients that subscribe to levels.
    void gather_levels();
    /// Notifies the subscribers of an event. Skips slow clients and the client `except`.
    void send_event(const std::string& event, const net::reply_json& params, client_number except = 0);
    /// Notifies the owner of a stroke, and the subscribers to strokes.
    void send_stroke_event(client_number owner, const net::reply_json& params);
    void send_stream_event(stream_state s, const std::string& reason);
    /// Notifies all subscribers that a client has stopped everything. `by` is the client's number, or 0 for
    /// the owner.
    void send_stop_event(client_number by);

private:
    void send_levels(client_number number);

    boost::asio::io_context& io_;
    const service_options& options_;
    level_peaks& peaks_;
    std::map<client_number, std::unique_ptr<client>> all_ = {};
    client_number last_ = 0;
    allowance refusals_ = {};                               ///< lines about refusals that may still be logged
    std::map<std::string, double> wrong_token_wait_s_ = {}; ///< last delay of an answer, by address
    std::function<void(client_number)> all_sent_ = {};
};

} // namespace tactor::server
