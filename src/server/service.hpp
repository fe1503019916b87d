// SPDX-License-Identifier: MIT
/// \file
/// The service without its sockets: clients, their strokes, who is told what.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>

#include <tactor/live.hpp>
#include <tactor/phantom.hpp>
#include <tactor/player.hpp>

#include "net/rpc.hpp"
#include "net/shared_by_peers.hpp"
#include "server/stream.hpp"
#include "server/stroke_source.hpp"

namespace tactor::server {

/// Bounds of what a client, and all together, may ask of the service.
struct service_limits {
    std::size_t max_clients = 128;
    std::size_t kept_clients = 8;     ///< of these, places for the Unix socket alone
    std::size_t max_strokes = 64;     ///< of one client at once, those that are being planned included
    std::size_t max_live_strokes = 4; ///< of these, live ones
    double max_points_per_s = 2000.0; ///< of one client; as many at once
    double max_stroke_s = 600.0;
    std::size_t max_message_bytes = 1U << 20;
    std::size_t max_nesting = 64;
    double max_message_s = 10.0;             ///< for a message to be complete, and for the first one to come
    std::size_t max_unread_bytes = 4U << 20; ///< that wait for one client
    std::size_t max_all_unread_bytes = 64U
                                       << 20; ///< for all, and as many of requests that wait to be planned
    std::size_t max_all_unfinished_bytes = 32U << 20; ///< of messages that have not come whole, of all
};

using client_number = std::uint64_t;

/// The way to a client. The service calls finish() never from within something that the connection does not
/// expect: it may be in the middle of it.
using client_link = net::peer;

struct service_options {
    planning plans = {};
    service_limits limits = {};
    std::string version = {};
    std::string token = {}; ///< that TCP needs; empty: none
    net::reply_json array = {};
    /// The tactor-plan/1 text of a plan; throws std::bad_alloc beyond so many bytes.
    std::function<std::string(const planned&, std::size_t most_bytes)> plan_text = {};
    /// CLOCK_MONOTONIC, ns.
    std::function<std::int64_t()> now_ns = {};
};

/// Where a client comes from.
enum class client_kind { local, network, web, datagram };

/// All members are called by the context's thread.
class service {
public:
    service(boost::asio::io_context& io, service_options o, stream_options s);
    ~service();
    service(const service&) = delete;
    service& operator=(const service&) = delete;

    void start() { stream_.start(); }
    /// How many clients there may be in all when one of this kind comes.
    std::size_t places(client_kind k) const noexcept;
    /// Whether there is a place for one more.
    bool has_place(client_kind k) const;
    /// Whether it is there, and no token of it is owed.
    bool is_admitted(client_number number) const;
    client_number connect(std::shared_ptr<client_link> link, client_kind k);
    /// One message. False when the connection is to be closed unanswered.
    bool receive(client_number number, std::string_view text);
    /// The same for a large message, which is read on another thread; `done` has the result, on this one.
    void receive_large(client_number number, std::string text, std::function<void(bool)> done);
    /// The client sends no more: its live strokes end. True when nothing is left to tell it.
    bool input_ended(client_number number);
    /// Called when that has become so.
    void on_told_all(std::function<void(client_number)> f) { told_all_ = std::move(f); }
    /// The client is gone: its live strokes end, the others play on.
    void disconnect(client_number number);
    /// Called when somebody stops everything.
    void on_stop(std::function<void()> f) { stopped_ = std::move(f); }
    /// Fades everything out and tells everybody; `done` when all ends were sent.
    void close(std::function<void()> done);

    stream& output() noexcept { return stream_; }
    /// The result of `status`.
    net::reply_json status_now();
    /// Whether a token is the one that is needed; any, where none is.
    bool admits(std::string_view token) const;

private:
    using reply_json = net::reply_json;
    struct client;
    struct stroke_record;
    struct pending;

    /// Where a result goes: a reply, a place in a batch, or nowhere.
    struct answer {
        std::shared_ptr<pending> all;
        std::size_t at = 0;

        /// `strokes`: new ones, of which notifications may come from now on.
        void result(reply_json r, const std::vector<std::uint32_t>& strokes = {}) const;
        /// One that is JSON text already, on one line.
        void result_text(const std::string& r) const;
        void fault(const net::rpc_fault& f) const;
    };

    /// How often stop, and cancel of all by one client, had been asked for when a stroke was.
    struct stop_mark {
        std::uint64_t stops = 0;
        std::shared_ptr<const std::uint64_t> cancels = {};
        std::uint64_t own = 0;
    };

    struct plan_job {
        answer to;
        net::json params; ///< of play and plan; freed when it is planned
        net::json start = "now";
        std::size_t bytes = 0;
        bool play = false;
        stop_mark asked = {};
        double steps = 0.0; ///< see planning_work; 0 until its text was read
    };

    /// Requests that wait to be planned, and the thread that plans them.
    struct planner_lane {
        std::size_t most_bytes; ///< of a request
        double most_steps;
        std::map<client_number, std::deque<plan_job>> queued = {};
        std::deque<client_number> turns = {}; ///< whose turn it is, of those that have some
        std::optional<answer> planning = {};  ///< where the result of the one that is being planned goes
        boost::asio::thread_pool thread{1};
    };

    // service.cpp
    bool receive(client_number number, net::rpc_message& m, std::size_t bytes);
    void handle(client& c, net::rpc_request& r, const answer& to, std::size_t bytes);
    bool admitted(client& c, const net::rpc_message& m);
    client* find(client_number c);
    std::size_t gone() const; ///< clients that send no more and are owed something
    void send(client& c, const reply_json& message);
    /// Returns the options of a stream that this hears of.
    stream_options heard(stream_options s);
    void tell_stream(stream_state s, const std::string& reason);
    void check_told_all(client_number number);
    void give_memory_back_when_quiet();

    // service_methods.cpp
    void hello(client& c, const net::json& params, const answer& to);
    void status(client& c, const net::json& params, const answer& to);
    void subscribe(client& c, const net::json& params, const answer& to);
    void send_levels(client_number number);
    void gather_levels();
    reply_json hello_result();
    reply_json limits_json() const;

    // service_jobs.cpp
    void plan_or_play(client& c, net::json&& params, const answer& to, bool play, std::size_t bytes);
    planner_lane& lane_for(const plan_job& j) noexcept;
    bool weigh(plan_job& j, const planner_lane& in, const planning_work& w);
    void move_up(planner_lane& from, plan_job&& j);
    void queue_job(client_number number, plan_job j);
    void next_job(planner_lane& lane);
    void keep_jobs(client_number gone);
    void refuse_jobs();
    void post_job(planner_lane& lane, plan_job j);
    void job_done(planner_lane& lane, const plan_job& job, std::shared_ptr<planned> p,
                  std::vector<score> scores, std::string text, std::optional<net::rpc_fault> fault);
    void submit_all(const plan_job& job, const std::shared_ptr<planned>& p, const std::vector<score>& scores);

    // service_strokes.cpp
    void drive(client& c, const net::json& params, const answer& to);
    std::vector<std::uint32_t> submit(client_number owner, const net::json& start, const planned& p,
                                      const std::vector<score>& scores, const char* ended_by);
    void check_free_place(const client& c) const;
    void cancel(client& c, const net::json& params, const answer& to);
    void cancel_all(client& c);
    void cancel(stroke_record& r, const char* why);
    void stop(client& c, const net::json& params, const answer& to);
    void stop_all(client_number by);
    void fire(client& c, const net::json& params, const answer& to);
    void release(const std::vector<std::uint32_t>& numbers);

    // service_live.cpp
    void begin(client& c, const net::json& params, const answer& to);
    void begin_now(client& c, const live_options& o, const answer& to, const char* ended_by);
    void to(client& c, const net::json& params, const answer& to);
    void end(client& c, const net::json& params, const answer& to);
    bool take_point(client& c);
    stroke_record& own_live(client& c, std::uint32_t number);

    // service_ends.cpp
    stroke_record& add_record(client_number owner);
    void begun(std::uint64_t player, stroke_id id, std::optional<std::int64_t> at_ns);
    void ended(std::uint64_t player, const stroke_report& r);
    void start_followers(stroke_record& first, std::int64_t at_ns);
    void finish(stroke_record& r, const stroke_report& how);
    void tell_stroke(stroke_record& r, std::string_view state, const stroke_report& how);
    void send_to_listeners(const stroke_record& r, const net::reply_json& message);
    std::string reason(const stroke_record& r, const stroke_report& how) const;
    const char* stopped_for(client_number owner) const;
    stop_mark mark(const client& c) const;
    const char* stopped_since(const stop_mark& m, client_number owner) const;
    void note_busy();

    boost::asio::io_context& io_;
    boost::asio::steady_timer quiet_; ///< since the last large message
    service_options options_;
    layout faces_;
    stream stream_;
    std::map<client_number, std::unique_ptr<client>> clients_;
    client_number last_client_ = 0;
    std::map<std::uint32_t, std::unique_ptr<stroke_record>> strokes_;
    std::map<std::pair<std::uint64_t, stroke_id>, std::uint32_t> by_player_;
    std::uint32_t last_stroke_ = 0;
    std::uint64_t stops_ = 0;
    client_number stopped_by_ = 0; ///< who asked for the last stop
    std::size_t planning_bytes_ = 0;
    std::size_t jobs_ = 0;
    bool closing_ = false;
    std::atomic<bool> ending_{false}; ///< the planner looks at it between strokes
    std::function<void(client_number)> told_all_;
    std::function<void()> stopped_;
    /// Small requests have threads of their own, so that they pass large ones: strokes of 4 s and 65 s, where
    /// they are continuous.
    std::array<planner_lane, 3> lanes_{
        {{16U << 10, 4096.0}, {128U << 10, 65536.0}, {SIZE_MAX, std::numeric_limits<double>::infinity()}}};
    boost::asio::thread_pool reader_{1}; ///< parses large messages, and frees what is large
};

} // namespace tactor::server
