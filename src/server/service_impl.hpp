// SPDX-License-Identifier: MIT
/// \file
/// Records of the service: clients, strokes and answers.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/faults.hpp"
#include "server/service.hpp"

namespace tactor::server {

/// Bytes waiting for a client that is behind. It misses levels, touches and stops until it has caught up.
constexpr std::size_t enough_waiting = 64U << 10;

struct service::client {
    client(boost::asio::io_context& io, client_number n, std::shared_ptr<client_link> l, client_kind k,
           std::string address)
        : number(n),
          link(std::move(l)),
          kind(k),
          from(k == client_kind::local ? "this computer" : std::move(address)),
          levels_timer(io)
    {
    }

    client_number number;
    std::shared_ptr<client_link> link;
    client_kind kind;
    std::string from;      ///< address, as others are shown it
    std::string name = {}; ///< as the client gave it
    bool greeted = false;  ///< network: its first message was hello
    bool admitted = false; ///< its token was right, or it needs none
    bool input_over = false;
    unsigned wrong_tokens = 0;
    std::set<std::string> events;
    double levels_hz = 30.0;
    boost::asio::steady_timer levels_timer;
    std::vector<float> levels; ///< by channel, since the last notification
    std::size_t coming = 0;    ///< requests whose strokes have no number yet
    std::size_t bytes = 0;     ///< of requests that wait to be planned
    std::size_t unanswered = 0;
    std::set<std::uint32_t> strokes; ///< strokes that have not ended
    std::size_t live = 0;
    /// Count of its cancels of all. Its requests share it, and may outlive the client.
    std::shared_ptr<std::uint64_t> cancels = std::make_shared<std::uint64_t>(0);
    allowance points = {}; ///< that it may send
    double level_db = 0.0; ///< of its strokes, below what they ask for
};

/// Rounds that are submitted again and again, so many frames after the last time.
struct repeated {
    score rounds;
    std::uint64_t frames = 0;
};

struct service::stroke_record {
    std::uint32_t number = 0;
    client_number owner = 0;
    std::uint64_t player = 0;
    std::vector<stroke_id> open = {}; ///< its submissions that have not ended, the newest last
    std::string state = "waiting";    ///< "armed", "started"
    std::optional<live_stroke> live = {};
    double intensity_max = 1.0;                     ///< value of its points' intensity that means 1
    double level_db = 0.0;                          ///< as its client set it ...
    double gain_db = 0.0;                           ///< ... and as it was played
    std::optional<point> touched = {};              ///< its last point
    std::optional<std::int64_t> touch_told_ns = {}; ///< when others were told a point
    bool released = false;                          ///< its number was sent
    const char* ended_by = nullptr;                 ///< reason, once it is cancelled or stopped
    std::vector<reply_json> held = {};
    std::optional<std::int64_t> asked_ns = {};
    std::optional<std::int64_t> started_ns = {};
    /// Other strokes of an armed file, and their starts after this one, s.
    std::vector<std::pair<std::uint32_t, double>> followers = {};
    std::optional<score> submits_later = {};  ///< score of a follower, until it is submitted
    std::optional<repeated> again = {};       ///< until it is to end
    bool next_waits = false;                  ///< the newest submission is a round that has not begun
    std::uint64_t frames = 0;                 ///< of the submissions that have ended
    std::optional<stroke_report> broken = {}; ///< end of the first one that did not finish
};

/// The replies to one message.
struct service::pending {
    struct place {
        net::json id = nullptr;
        bool wanted = false;
        bool given = false;
        bool file = false; ///< the reply may be longer than what waits for a client
        std::string reply = {};
    };

    pending(service& s, client_number c) : owner(s), to(c) {}
    void give(std::size_t at, std::string reply, const std::vector<std::uint32_t>& strokes);

    service& owner;
    client_number to;
    bool batch = false;
    std::vector<place> places;
    std::size_t open = 0;
    std::vector<std::uint32_t> numbers = {}; ///< strokes to release when it is sent
};

} // namespace tactor::server
