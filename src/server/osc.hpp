// SPDX-License-Identifier: MIT
/// \file
/// OSC: messages as requests in terms of the protocol, and senders as clients of the service. Knows no
/// socket: packets come in and go out by functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "net/osc.hpp"
#include "net/rpc.hpp"
#include "server/service.hpp"

namespace tactor::server {

struct osc_request {
    std::string method; ///< method of the protocol; empty: a button's release, which has no effect
    net::json params = net::json::object();
    std::int32_t number = 0; ///< the sender's number for its stroke; 0: none
    std::uint16_t port = 0;  ///< port at which a subscriber listens; 0: the port from which it sends
    std::size_t bytes = 0;   ///< bytes of its texts
};

/// Returns true for messages that a server sends: they are never answered, so that two servers do not talk
/// for ever.
bool is_servers_own(std::string_view address);

/// Reads a message.
/// \throws fault_error for unknown addresses, and for wrong values.
osc_request read_osc(const net::osc_message& m);

/// Server of all senders. Each address and port is a client while it has strokes, requests without an answer,
/// messages for later or a subscription. Otherwise it is forgotten. Members are called in the context's
/// thread.
class osc_clients {
public:
    using endpoint = boost::asio::ip::udp::endpoint;

    struct outside {
        std::function<void(const endpoint& to, const std::string& packet)> send;
        std::function<std::int64_t()> now_ns;  ///< CLOCK_MONOTONIC
        std::function<std::int64_t()> unix_ns; ///< system clock, to which time tags refer
    };

    /// Most live strokes of a sender that wait for their time.
    static constexpr std::size_t most_held = 64;
    /// Most messages that wait for the number of a stroke that is being planned or begun.
    static constexpr std::size_t most_waiting = 256;
    /// Most errors sent in any second, so that forged packets cannot flood the address that they name.
    static constexpr std::size_t most_errors = 10;
    static constexpr double farthest_s = 60.0;     ///< greatest time that a time tag may be ahead
    static constexpr double subscription_s = 10.0; ///< time after which a subscription must be renewed

    osc_clients(boost::asio::io_context& io, service& s, outside o);
    ~osc_clients();
    osc_clients(const osc_clients&) = delete;
    osc_clients& operator=(const osc_clients&) = delete;

    void receive(std::string_view packet, const endpoint& from);
    /// Returns the time at which act() has something to do, CLOCK_MONOTONIC.
    std::optional<std::int64_t> next_ns() const;
    /// Begins the strokes, and ends the subscriptions, that are due.
    void act();
    /// Drops the strokes that have not begun, and notifies their senders.
    void drop_held();
    /// Returns the number of known senders.
    std::size_t count() const noexcept { return senders_.size(); }

private:
    class sender_link;
    struct held {
        endpoint from;
        osc_request request; ///< a begin, or the end of a subscription
    };
    using held_messages = std::multimap<std::int64_t, held>; ///< by due time

    /// A stroke with a number of the sender's choice.
    struct drawn {
        std::optional<std::uint32_t> stroke = {}; ///< number of the service, once it is known
        bool held = false;                        ///< it waits for its time
        double intensity_max = 1.0;               ///< value of its points that means 1
        bool is_loud = false;                     ///< a point above intensity 1 was reported
        std::deque<osc_request> waiting = {};     ///< messages until its number is known
    };

    struct sender {
        client_number client = 0;
        std::size_t unanswered = 0; ///< requests to the service
        std::map<std::int32_t, drawn> drawn_as = {};
        std::map<std::uint32_t, std::int32_t> numbers =
            {}; ///< current strokes: the sender's by the service's
        std::size_t held = 0;
        std::optional<held_messages::iterator> unsubscribes = {}; ///< end of its subscription
        std::uint16_t port = 0;                                   ///< destination of the subscription

        bool idle() const
        {
            return unanswered == 0 && drawn_as.empty() && numbers.empty() && held == 0 && !unsubscribes;
        }
    };

    void take(const net::osc_message& m, const endpoint& from);
    void touch(const net::osc_message& m, const endpoint& from);
    void stop(const endpoint& from);
    void subscribe(const osc_request& r, const endpoint& from);
    void move(osc_request r, const endpoint& from);
    void draw(osc_request r, std::optional<std::int64_t> at_ns, const endpoint& from);
    void drop_held(const std::function<bool(const held&)>& which);
    void read_clocks();
    std::optional<std::int64_t> due_ns(const net::osc_message& m) const;
    std::int64_t lead_ns();
    sender* find(const endpoint& from);
    sender& admit(const endpoint& from);
    void ask(const endpoint& from, osc_request r);
    void ask_about(const endpoint& from, drawn& d, osc_request r);
    void answer(const endpoint& to, const osc_request& r, const net::reply_json& result,
                const net::rpc_fault* why);
    void notify(const endpoint& to, std::string_view method, const net::reply_json& params);
    void flush(const endpoint& from, std::int32_t number);
    void send_stroke(const endpoint& to, std::int32_t number, const std::string& state);
    void refuse(const endpoint& to, const std::string& address, const std::string& why);
    void check_later(const endpoint& e);
    void forget_idle();
    template <typename F>
    void later(F f);

    boost::asio::io_context& io_;
    service& service_;
    outside outside_;
    std::map<endpoint, sender> senders_;
    held_messages held_;
    std::set<endpoint> to_check_;        ///< senders that may be idle
    std::deque<std::int64_t> errors_ns_; ///< times of the last errors, the oldest first
    std::int64_t unix_ns_ = 0;           ///< time of the packet by the system clock
    std::int64_t offset_ns_ = 0;         ///< CLOCK_MONOTONIC minus the system's clock
    std::shared_ptr<const int> alive_ = std::make_shared<const int>();
};

} // namespace tactor::server
