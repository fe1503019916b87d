// SPDX-License-Identifier: MIT
/// \file
/// OSC messages as requests in terms of the protocol, and OSC senders as clients of the service. This code
/// does not use sockets: functions pass packets in and out.
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
    std::string method; ///< method of the protocol; empty if a button was released, which has no effect
    net::json params = net::json::object();
    std::int32_t number = 0; ///< sender's own number for its stroke; 0 if none
    std::uint16_t port = 0;  ///< port to which notifications go; 0 for the sender's port
    std::size_t bytes = 0;   ///< bytes of the message's texts
};

/// Returns true for messages that only servers send. They are never answered: otherwise two servers could
/// send messages to each other for ever.
bool is_server_message(std::string_view address);

/// Converts a message to a request.
/// \throws fault_error for an unknown address or a wrong value.
osc_request read_osc(const net::osc_message& m);

/// Server for all senders. A sender is an address and a port. It is a client while it has strokes, unanswered
/// requests, delayed messages or a subscription. After that the server forgets it. Call the members in the
/// context's thread.
class osc_clients {
public:
    using endpoint = boost::asio::ip::udp::endpoint;

    struct outside {
        std::function<void(const endpoint& to, const std::string& packet)> send;
        std::function<std::int64_t()> now_ns;  ///< returns CLOCK_MONOTONIC
        std::function<std::int64_t()> unix_ns; ///< returns the system clock, to which time tags refer
    };

    /// Greatest number of a sender's live strokes that may wait for their start times.
    static constexpr std::size_t most_held = 64;
    /// Greatest number of messages that may wait until their stroke has a number, because it is being planned
    /// or started.
    static constexpr std::size_t most_waiting = 256;
    /// Greatest number of errors that are sent in one second. Without a limit, packets with a forged address
    /// could flood this address with errors.
    static constexpr std::size_t most_errors = 10;
    static constexpr double farthest_s = 60.0;     ///< greatest distance of a time tag into the future
    static constexpr double subscription_s = 10.0; ///< lifetime of a subscription; it can be renewed

    osc_clients(boost::asio::io_context& io, service& s, outside o);
    ~osc_clients();
    osc_clients(const osc_clients&) = delete;
    osc_clients& operator=(const osc_clients&) = delete;

    void receive(std::string_view packet, const endpoint& from);
    /// Returns the time at which process_pending() must be called, CLOCK_MONOTONIC.
    std::optional<std::int64_t> next_ns() const;
    /// Begins the strokes that are due, and ends the subscriptions that have expired.
    void process_pending();
    /// Drops the strokes that have not begun yet, and notifies their senders.
    void drop_held_strokes();
    /// Returns the number of known senders.
    std::size_t count() const noexcept { return senders_.size(); }

private:
    class sender_link;
    struct held {
        endpoint from;
        osc_request request; ///< a begin, or the end of a subscription
    };
    using held_messages = std::multimap<std::int64_t, held>; ///< by due time

    /// A stroke with a number that its sender chose.
    struct drawn {
        std::optional<std::uint32_t> stroke = {}; ///< the service's number of the stroke, once it is known
        bool held = false;                        ///< true while it waits for its start time
        double intensity_max = 1.0;               ///< intensity of a point that means 1
        bool is_loud = false;                     ///< true once a point above intensity 1 was reported
        std::deque<osc_request> waiting = {};     ///< messages that wait for the stroke's number
    };

    struct sender {
        client_number client = 0;
        std::size_t unanswered = 0; ///< requests that the service has not answered yet
        std::map<std::int32_t, drawn> drawn_as = {};
        std::map<std::uint32_t, std::int32_t> numbers =
            {}; ///< sender's numbers of current strokes, by the service's numbers
        std::size_t held = 0;
        std::optional<held_messages::iterator> unsubscribes = {}; ///< entry that ends the subscription
        std::uint16_t port = 0;                                   ///< as osc_request::port

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
    void drop_held_strokes(const std::function<bool(const held&)>& which);
    void read_clocks();
    std::optional<std::int64_t> due_ns(const net::osc_message& m) const;
    std::int64_t lead_ns();
    sender* find(const endpoint& from);
    sender& admit(const endpoint& from);
    void ask(const endpoint& from, osc_request r);
    void forward_request(const endpoint& from, drawn& d, osc_request r);
    void answer(const endpoint& to, const osc_request& r, const net::reply_json& result,
                const net::rpc_fault* why);
    void notify(const endpoint& to, std::string_view method, const net::reply_json& params);
    void flush(const endpoint& from, std::int32_t number);
    void send_stroke(const endpoint& to, std::int32_t number, const std::string& state);
    void refuse(const endpoint& to, const std::string& address, const std::string& why);
    void schedule_idle_check(const endpoint& e);
    void drop_idle_senders();
    template <typename F>
    void later(F f);

    boost::asio::io_context& io_;
    service& service_;
    outside outside_;
    std::map<endpoint, sender> senders_;
    held_messages held_;
    std::set<endpoint> to_check_;        ///< senders that may have become idle
    std::deque<std::int64_t> errors_ns_; ///< times of recent errors, oldest first
    std::int64_t unix_ns_ = 0;           ///< time of the current packet on the system clock
    std::int64_t offset_ns_ = 0;         ///< CLOCK_MONOTONIC minus the system clock
    std::shared_ptr<const int> alive_ = std::make_shared<const int>();
};

} // namespace tactor::server
