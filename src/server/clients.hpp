// SPDX-License-Identifier: MIT
/// \file
/// The clients of the service: their places, tokens, limits and subscriptions.
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

/// Number of bytes waiting for a client from which on it is behind. It misses levels, touches and stops until
/// it has caught up.
inline constexpr std::size_t enough_waiting = 64U << 10;

/// Rate limit: the number of actions that are allowed at once. It is full again after a second.
struct allowance {
    double remaining = std::numeric_limits<double>::infinity();
    std::int64_t at_ns = 0;

    /// Takes `n` of at most `per_s`. Returns false if fewer are left.
    bool take(double n, double per_s, std::int64_t now_ns) noexcept
    {
        remaining = std::min(per_s, remaining + seconds(now_ns - std::exchange(at_ns, now_ns)) * per_s);
        if (remaining < n)
            return false;
        remaining -= n;
        return true;
    }
};

/// Link to a client. Its finish() must not call the service back at once, which may be in the middle of
/// another call.
using client_link = net::peer;

/// Kind of connection of a client.
enum class client_kind {
    local,
    network,
    web,
    datagram,
    bhaptics, ///< a program whose protocol has no token
};

/// A client, and counts of what it has requested.
struct client {
    client_number number;
    std::shared_ptr<client_link> link;
    client_kind kind;
    std::string from;      ///< address, as other clients see it
    std::string name = {}; ///< name that the client chose
    bool greeted = false;  ///< network: its first message was hello
    bool admitted = false; ///< its token was right, or it needs none
    bool input_over = false;
    unsigned wrong_tokens = 0;
    unsigned refusals_waiting = 0; ///< delayed answers to wrong tokens
    std::set<std::string> events = {};
    double levels_hz = 30.0;
    boost::asio::steady_timer levels_timer;
    std::vector<float> levels = {}; ///< peaks by channel since the last notification
    std::size_t coming = 0;         ///< requests whose strokes have no number yet
    std::size_t bytes = 0;          ///< bytes of requests that wait to be planned
    std::size_t unanswered = 0;
    std::set<std::uint32_t> strokes = {}; ///< strokes that have not ended
    std::size_t live = 0;
    /// Number of times that the client cancelled all its strokes. Its requests share the count, and may
    /// outlive the client.
    std::shared_ptr<std::uint64_t> cancels = std::make_shared<std::uint64_t>(0);
    allowance points = {}; ///< points that it may still send now
    double level_db = 0.0; ///< level of its strokes, relative to their own

    /// Returns true for subscribers of an event that are not behind.
    bool hears(const std::string& event) const
    {
        return events.contains(event) && link->waiting() < enough_waiting;
    }
};

/// Clients of a service. Members are called in the context's thread.
class client_list {
public:
    /// Keeps references to the options and to the meter of levels.
    client_list(boost::asio::io_context& io, const service_options& o, level_peaks& peaks)
        : io_(io), options_(o), peaks_(peaks)
    {
    }

    /// Returns the greatest total of clients at which another one of this kind may come.
    std::size_t places(client_kind k) const noexcept;
    /// Returns true if there is a place for another client.
    bool has_place(client_kind k) const;
    client& add(std::shared_ptr<client_link> link, client_kind k, std::string from);
    /// Returns a client; null if it has gone.
    client* find(client_number number) const;
    /// Removes a client. Its counts stay valid until the result is destroyed.
    std::unique_ptr<client> remove(client_number number);
    const std::map<client_number, std::unique_ptr<client>>& all() const noexcept { return all_; }

    /// Sets the handler for the moment when a client that sends no more has been sent all its messages.
    void on_all_sent(std::function<void(client_number)> f) { all_sent_ = std::move(f); }
    /// Calls that handler if the moment has come. Returns true if it has, or if the client has gone.
    bool check_all_sent(client_number number);
    /// Disconnects the first client that sends no more, if there are more of them than places.
    void limit_silent();

    /// Returns true if the client is connected and needs no token any more.
    bool is_admitted(client_number number) const;
    /// Returns true if a token is right, or if none is needed.
    bool admits(std::string_view token) const;
    /// Returns true for a client that needs no token any more, or whose token (null: none) is right.
    /// Otherwise calls `refuse`: at once without a token, and late for a wrong one. After the third closes
    /// the connection.
    bool admit(client& c, const std::string* token, std::function<void()> refuse);
    /// Counts and logs a wrong token from an address. Returns the delay of its answer, s, which grows with
    /// the number of wrong tokens from there.
    double count_wrong_token(const std::string& from);
    /// Logs the refusal of a connection or a message. `from`: its address; empty: this computer. Writes at
    /// most some ten lines a second.
    void log_refusal(const std::string& from, std::string_view why);

    /// Sets the events that a client is notified of, and how often of levels.
    void subscribe(client& c, std::set<std::string> events, double levels_hz);
    /// Adds the peaks of the common meter to the levels of each client that subscribed to them.
    void gather_levels();
    /// Notifies the subscribers of an event, except for one client. Clients that are behind get nothing.
    void tell(const std::string& event, const net::reply_json& params, client_number except = 0);
    /// Notifies the owner of a stroke and the subscribers.
    void tell_stroke(client_number owner, const net::reply_json& params);
    void tell_stream(stream_state s, const std::string& reason);
    /// Notifies all subscribers of the client that stopped everything; 0: the owner.
    void tell_stop(client_number by);

private:
    void send_levels(client_number number);

    boost::asio::io_context& io_;
    const service_options& options_;
    level_peaks& peaks_;
    std::map<client_number, std::unique_ptr<client>> all_ = {};
    client_number last_ = 0;
    allowance refusals_ = {};                               ///< lines of refusals that may be logged
    std::map<std::string, double> wrong_token_wait_s_ = {}; ///< delay of the last answer, by address
    std::function<void(client_number)> all_sent_ = {};
};

} // namespace tactor::server
