// SPDX-License-Identifier: MIT
/// \file
/// The service without its sockets: requests of clients, and their strokes.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <tactor/error.hpp>
#include <tactor/phantom.hpp>
#include <tactor/player.hpp>

#include "net/rpc.hpp"
#include "options/serve.hpp"
#include "server/clients.hpp"
#include "server/planners.hpp"
#include "server/request.hpp"
#include "server/stream.hpp"
#include "server/view.hpp"

namespace tactor::server {

using service_limits = options::serve_limits;

/// Receives the answer to a request of this process: a result, or the reason why there is none.
using answer_handler = std::function<void(const net::reply_json& result, const net::rpc_fault* why)>;

struct service_options {
    planning plans = {};
    service_limits limits = {};
    std::string version = {};
    std::string token = {}; ///< token that TCP clients need; empty: none
    net::reply_json array = {};
    /// Returns the tactor-plan/1 text of a plan; throws std::bad_alloc beyond `most_bytes`.
    std::function<std::string(const planned&, std::size_t most_bytes)> plan_text = {};
    /// CLOCK_MONOTONIC, ns.
    std::function<std::int64_t()> now_ns = {};
    log_function log = {}; ///< receives a line for each stroke that ends
};

/// Submissions of a planned stroke, at equal distances in frames.
struct submissions {
    std::optional<score> again = {}; ///< score of the next submission; none: there is no next one
    std::uint64_t frames = 0;
    std::uint64_t offset = 0;                ///< frames from the beginning of its request to its own
    std::uint64_t newest = 0;                ///< number of the newest one, from 0 on
    std::optional<std::uint64_t> last = {};  ///< number of the last one, once it is decided
    std::optional<std::uint64_t> begun = {}; ///< frame in which its request began
};

/// Clients and their strokes on one stream. Members are called in the context's thread.
class service {
public:
    service(boost::asio::io_context& io, service_options o, stream_options s);
    ~service();
    service(const service&) = delete;
    service& operator=(const service&) = delete;

    void start() { stream_.start(); }
    /// Adds a client. `from`: its address; a local one needs none.
    client_number connect(std::shared_ptr<client_link> link, client_kind k, std::string from = {})
    {
        return clients_.add(std::move(link), k, std::move(from)).number;
    }
    /// Handles a message. Returns false if the connection must be closed unanswered.
    bool receive(client_number number, std::string_view text);
    /// Handles a request of `bytes` that is no message. Calls `answered`, if there is one, unless the client
    /// has gone.
    void receive(client_number number, net::rpc_request r, std::size_t bytes, answer_handler answered);
    /// Handles a large message, which another thread parses. Calls `done` with the result in this
    /// thread.
    void receive_large(client_number number, std::string text, std::function<void(bool)> done);
    /// Does a client's work on a planner's thread, then calls `done` in this thread unless the client has
    /// gone. Work for which memory runs out counts as done.
    void aside(client_number number, const std::function<void()>& work, std::function<void()> done);
    /// Ends the live and held strokes of a client that sends no more. Returns true if it has been sent all
    /// its messages.
    bool input_ended(client_number number);
    /// Removes a client: its live and held strokes end, its other strokes play on.
    void disconnect(client_number number);
    /// Sets the handler for a stop of everything.
    void on_stop(std::function<void()> f) { stopped_ = std::move(f); }
    /// Fades everything out and notifies all clients; calls `done` when all ends were sent.
    void close(std::function<void()> done);

    client_list& clients() noexcept { return clients_; }
    stream& output() noexcept { return stream_; }
    const array& tactors() const noexcept { return options_.plans.tactors; }
    /// Returns the result of `status`.
    net::reply_json status_now();

private:
    using reply_json = net::reply_json;

    /// Reason of a held stroke's end.
    static constexpr const char* connection_ended = "its client's connection has ended";

    struct stroke_record {
        std::uint32_t number = 0;
        client_number owner = 0;
        std::uint64_t player = 0;
        std::vector<stroke_id> open = {}; ///< its submissions that have not ended, the newest last
        std::string state = "waiting";    ///< "armed", "started"
        std::optional<live_stroke> live = {};
        double intensity_max = 1.0;                ///< value of its points' intensity that means 1
        double level_db = 0.0;                     ///< level, as set by its client ...
        double gain_db = 0.0;                      ///< ... and as it was played
        std::optional<point> touched = {};         ///< its last point
        std::optional<std::int64_t> shown_ns = {}; ///< time at which others last got a point
        bool released = false;                     ///< its number was sent to the client
        const char* ended_by = nullptr;            ///< reason, once it is cancelled or stopped
        std::vector<reply_json> held = {};
        std::optional<std::int64_t> requested_ns = {};
        std::optional<std::int64_t> started_ns = {};
        /// Other strokes of an armed file, and their starts, s after this one.
        std::vector<std::pair<std::uint32_t, double>> followers = {};
        std::optional<score> submits_later = {}; ///< score of a follower, until it is submitted
        submissions rounds = {};
        bool ends_with_client = false;            ///< cancelled when its client's connection ends
        std::uint32_t request = 0;                ///< number of the first stroke of its request
        bool next_waits = false;                  ///< the newest submission is a round that has not begun
        std::uint64_t frames = 0;                 ///< frames of the submissions that have ended
        std::string name = {};                    ///< name for the log, as the next two
        double requested_db = 0.0;                ///< requested level ...
        bool is_sl = false;                       ///< ... in dB SL, not dBFS
        std::optional<stroke_report> broken = {}; ///< report of the first submission that did not finish
    };

    /// Replies to one message.
    struct pending {
        struct place {
            net::json id = nullptr;
            bool wanted = false;
            bool filled = false;
            bool file = false; ///< the reply may be longer than the limit of waiting bytes
            std::string reply = {};
        };

        void give(std::size_t at, std::string reply, const std::vector<std::uint32_t>& strokes);
        void give(std::size_t at, const reply_json& result, const net::rpc_fault* why,
                  const std::vector<std::uint32_t>& strokes);

        service& owner;
        client_number to;
        bool batch = false;
        answer_handler answered = {}; ///< takes the only reply as values
        std::vector<place> places = {};
        std::size_t open = 0;
        std::vector<std::uint32_t> numbers = {}; ///< strokes to release when the replies are sent
    };

    /// Counts of stops, and of cancels of all by one client, at the time of a request.
    struct stop_mark {
        std::uint64_t stops = 0;
        std::shared_ptr<const std::uint64_t> cancels = {};
        std::uint64_t own = 0;
    };

    /// Destination of a result: a reply, a place in a batch, or none.
    struct answer {
        std::shared_ptr<pending> all;
        std::size_t at = 0;
        stop_mark since = {};

        /// Sends the result. `strokes`: new ones, whose notifications are sent from now on.
        void result(const reply_json& r, const std::vector<std::uint32_t>& strokes = {}) const;
        /// Returns the reply with a result that is already JSON text on one line. Any thread.
        std::string write_reply(std::string_view result) const;
        /// Sends a reply of write_reply(). `file`: it may be longer than the limit of waiting bytes.
        void whole_reply(std::string reply, bool file) const;
        void fault(const net::rpc_fault& f) const;
    };

    struct plan_job {
        answer to;
        std::string method; ///< "play", "plan", "import" or "export"
        std::size_t bytes = 0;
        net::json params = {}; ///< freed after planning
        options::option_values values =
            {}; ///< options of play and plan: the owner's, overridden by the request's
        net::json start = "now";
        double gain_db = 0.0;     ///< gain of all its strokes
        std::uint64_t rounds = 1; ///< number of rounds; 0: until they are cancelled
        double round_s = 0.0;     ///< least length of a round
        double pause_s = 0.0;     ///< silence after it
        bool held = false;        ///< cancelled when its client's connection ends
        view_choice view = {};
        std::optional<double> draft = {};

        // Results.
        std::shared_ptr<planned> made = {};
        std::vector<score> scores = {};
        std::string text = {};
        std::optional<net::rpc_fault> fault = {};

        bool plays() const { return method == "play"; }
        bool is_file() const { return method == "import" || method == "export"; }
    };

    // service.cpp
    bool receive(client_number number, net::rpc_message& m, std::size_t bytes, const stop_mark& since,
                 answer_handler answered = {});
    void handle(client& c, net::rpc_request& r, const answer& to, std::size_t bytes);
    bool admitted(client& c, const net::rpc_message& m);
    /// Returns stream options with handlers that call this service.
    stream_options with_handlers(stream_options s);
    void give_memory_back_when_quiet();

    // service_methods.cpp
    void hello(client& c, const net::json& params, const answer& to);
    void status(client& c, const net::json& params, const answer& to);
    void list_options(client& c, const net::json& params, const answer& to);
    void make_qr(client& c, const net::json& params, const answer& to);
    void tell_stroke(stroke_record& r, std::string_view state, const stroke_report& how);
    void subscribe(client& c, const net::json& params, const answer& to);
    reply_json hello_result(const client& c);
    reply_json limits_json() const;
    void touch(stroke_record& r);
    void tell_touch(const stroke_record& r, bool down);

    // service_jobs.cpp
    void add_job(client& c, net::rpc_request& r, const answer& to, std::size_t bytes);
    void read_job(plan_job& j) const;
    void work_on(plan_job& j);
    std::string make_text(const plan_job& j, const go_on_check& go_on);
    void make_scores(plan_job& j, const go_on_check& go_on);
    void job_done(const std::shared_ptr<plan_job>& j);
    void refuse(const plan_job& j, const net::rpc_fault& f);
    void forget(const plan_job& j);
    void uncount(const plan_job& j);
    void submit_all(const plan_job& job);
    std::uint64_t count_rounds(const plan_job& job, const planned& p) const;

    // service_strokes.cpp
    void drive(client& c, const net::json& params, const answer& to);
    std::vector<std::uint32_t> submit(client_number owner, const net::json& start, const planned& p,
                                      const std::vector<score>& scores, const char* ended_by,
                                      double gain_db = 0.0, bool again = false);
    void submit_next(stroke_record& r);
    void check_free_place(const client& c) const;
    std::vector<std::uint32_t> end_unbegun(client_number owner, std::size_t n, const char* why);
    void once_ready(const answer& to, const char* source, std::function<void()> then);
    void level(client& c, const net::json& params, const answer& to);
    void set_level(stroke_record& r, double db);
    static double level_db(const stroke_record& r) noexcept;
    player* find_player(const stroke_record& r) const noexcept;
    void cancel(client& c, const net::json& params, const answer& to);
    void cancel(stroke_record& r, const char* why);
    void stop(client& c, const net::json& params, const answer& to);
    void stop_all(client_number by);
    void fire(client& c, const net::json& params, const answer& to);
    void release(const std::vector<std::uint32_t>& numbers);
    void begin(client& c, const net::json& params, const answer& to);
    void begin_now(client& c, const live_options& o, double intensity_max, const answer& to);
    void to(client& c, const net::json& params, const answer& to);
    void end(client& c, const net::json& params, const answer& to);
    stroke_record& own_stroke(const client& c, std::uint32_t number);
    stroke_record& own_live(client& c, std::uint32_t number);

    stroke_record& add_record(client_number owner);
    void begun(std::uint64_t player, stroke_id id, std::optional<std::int64_t> at_ns);
    void ended(std::uint64_t player, const stroke_report& r);
    void start_followers(stroke_record& first, std::int64_t at_ns);
    void note_beginning(stroke_record& r, stroke_id id);
    void end_rounds(stroke_record& r);
    std::vector<stroke_record*> find_request(const stroke_record& r);
    std::optional<std::uint64_t> end_request(const stroke_record& of);
    std::uint64_t end_requests(client_number owner, const std::vector<std::uint32_t>& numbers);
    void add_submission(stroke_record& r, stroke_id id);
    void finish(stroke_record& r, const stroke_report& how);
    std::string reason(const stroke_record& r, const stroke_report& how) const;
    static void note_sound(stroke_record& r, std::string_view name, const render_options& o);
    std::string log_name(const stroke_record& r);
    const char* stop_reason(client_number owner) const;
    stop_mark mark(const client& c) const;
    const char* stop_reason_since(const answer& to) const;
    void note_busy();

    boost::asio::io_context& io_;
    boost::asio::steady_timer quiet_; ///< fires 500 ms after the last large message
    service_options options_;
    layout faces_;
    stream stream_;
    client_list clients_{io_, options_, stream_.peaks()};
    std::map<std::uint32_t, stroke_record> strokes_;
    std::map<std::pair<std::uint64_t, stroke_id>, std::uint32_t> by_player_;
    std::uint32_t last_stroke_ = 0;
    std::uint64_t stops_ = 0;
    client_number stopped_by_ = 0; ///< client of the last stop
    boost::asio::steady_timer touch_timer_;
    std::set<std::uint32_t> touches_due_ = {}; ///< live strokes with a place to be sent
    allowance touches_ = {};
    std::size_t jobs_ = 0;            ///< number of jobs that wait for planning or are being planned
    std::atomic<bool> ending_{false}; ///< a planner also checks it between strokes
    std::function<void()> stopped_;
    planners planners_{io_};
};

} // namespace tactor::server
