// SPDX-License-Identifier: MIT
/// \file
/// The service without its sockets: clients' requests and strokes.
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

/// Function that receives the answer to a request from within this process: a result, or the reason why there
/// is no result.
using answer_handler = std::function<void(const net::reply_json& result, const net::rpc_fault* why)>;

struct service_options {
    planning plans = {};
    service_limits limits = {};
    std::string version = {};
    std::string token = {}; ///< token that TCP clients need; empty if they need none
    net::reply_json array = {};
    /// Returns the text of a plan in the format tactor-plan/1. Throws std::bad_alloc if it has more than
    /// `most_bytes`.
    std::function<std::string(const planned&, std::size_t most_bytes)> plan_text = {};
    /// Returns CLOCK_MONOTONIC, ns.
    std::function<std::int64_t()> now_ns = {};
    log_function log = {}; ///< gets a line for each stroke that ends
};

/// Submissions of a planned stroke. They are at equal distances, in frames.
struct submissions {
    std::optional<score> again = {}; ///< score of the next submission, if there will be one
    std::uint64_t frames = 0;
    std::uint64_t offset = 0;                ///< frames from the start of the request to that of the stroke
    std::uint64_t newest = 0;                ///< number of the newest submission, from 0
    std::optional<std::uint64_t> last = {};  ///< number of the last submission, once it is known
    std::optional<std::uint64_t> begun = {}; ///< stream frame in which the request began, once known
};

/// Clients, and their strokes on a stream. Call the members in the context's thread.
class service {
    struct answer;

public:
    service(boost::asio::io_context& io, service_options o, stream_options s);
    ~service();
    service(const service&) = delete;
    service& operator=(const service&) = delete;

    void start() { stream_.start(); }
    /// Adds a client. `from` is the client's address, which a local client does not need.
    client_number connect(std::shared_ptr<client_link> link, client_kind k, std::string from = {})
    {
        return clients_.add(std::move(link), k, std::move(from)).number;
    }
    /// A method of the protocol.
    struct method {
        const char* name;
        net::reply_json params; ///< schema of the object of all parameters; {} allows any parameters
        net::reply_json result; ///< schema of the members that each result has
        /// Handler in the context's thread. Null for a method that planner threads handle.
        void (service::*call)(client& c, const net::json& params, const answer& to) = nullptr;
    };
    /// Returns the table of methods.
    static const std::vector<method>& methods();
    /// Returns the schemas of the parameters of all notifications, by their names.
    static const net::reply_json& notifications();
    /// Handles a message. Returns false if the connection must be closed without an answer.
    bool receive(client_number number, std::string_view text);
    /// Handles a request that did not arrive as a message. `bytes` is its size. Calls `answered`, if it is
    /// set, unless the client has disconnected.
    void receive(client_number number, net::rpc_request r, std::size_t bytes, answer_handler answered);
    /// Handles a large message, which a planner thread parses. Calls `done` with the result in the context's
    /// thread.
    void receive_large_message(client_number number, std::string text, std::function<void(bool)> done);
    /// Does a client's work on a planner's thread, then calls `done` in this thread unless the client has
    /// gone. Work for which memory runs out counts as done.
    void run_on_planner(client_number number, const std::function<void()>& work, std::function<void()> done);
    /// Handles the end of a client's input: ends the client's live and held strokes. Returns true if all
    /// messages to the client have been sent.
    bool input_ended(client_number number);
    /// Removes a client. Its live and held strokes end, but its other strokes continue.
    void disconnect(client_number number);
    /// Sets a handler that is called when everything is stopped.
    void on_stop(std::function<void()> f) { stopped_ = std::move(f); }
    /// Fades out all strokes and notifies all clients. Calls `done` when clients have been notified of the
    /// end of every stroke.
    void close(std::function<void()> done);

    client_list& clients() noexcept { return clients_; }
    stream& output() noexcept { return stream_; }
    const array& tactors() const noexcept { return options_.plans.tactors; }
    /// Returns the result of the method `status`.
    net::reply_json status_json();

private:
    using reply_json = net::reply_json;

    /// Reason for the end of a held stroke whose client's connection has ended.
    static constexpr const char* connection_ended = "its client's connection has ended";

    struct stroke_record {
        std::uint32_t number = 0;
        client_number owner = 0;
        std::uint64_t player = 0;
        std::vector<stroke_id> open = {}; ///< submissions that have not ended yet, the newest last
        std::string state = "waiting";    ///< "waiting", "armed", "started" or "ended"
        std::optional<live_stroke> live = {};
        double intensity_max = 1.0;                ///< intensity of a point that means 1
        double level_db = 0.0;                     ///< level that the client has set for the stroke
        double gain_db = 0.0;                      ///< gain of the request; it is added to the level
        std::optional<point> touched = {};         ///< last point of a live stroke
        std::optional<std::int64_t> shown_ns = {}; ///< time at which other clients last received a point
        bool released = false;                     ///< true once the client has received the number
        const char* ended_by = nullptr;            ///< reason for the end of a cancelled or stopped stroke
        std::vector<reply_json> held = {};
        std::optional<std::int64_t> requested_ns = {};
        std::optional<std::int64_t> started_ns = {};
        /// Other strokes of an armed file, and their starts in seconds after the start of this stroke.
        std::vector<std::pair<std::uint32_t, double>> followers = {};
        std::optional<score> submits_later = {}; ///< score of a follower that is not yet submitted
        submissions rounds = {};
        bool ends_with_client = false;            ///< true if it ends with its client's connection
        std::uint32_t request = 0;                ///< number of the first stroke of the same request
        bool next_waits = false;                  ///< true if the newest submission, a repeat, has not begun
        std::uint64_t frames = 0;                 ///< frames of all submissions that have ended
        std::string name = {};                    ///< for the log, as are the next two members
        double requested_db = 0.0;                ///< requested level
        bool is_sl = false;                       ///< true if the requested level is in dB SL, not in dBFS
        std::optional<stroke_report> broken = {}; ///< report of the first submission that did not finish
    };

    /// Replies to one message, which may be a batch.
    struct pending {
        struct place {
            net::json id = nullptr;
            bool wanted = false;
            bool filled = false;
            bool file = false; ///< true if the reply may exceed the limit of waiting bytes
            std::string reply = {};
        };

        void give(std::size_t at, std::string reply, const std::vector<std::uint32_t>& strokes);
        void give(std::size_t at, const reply_json& result, const net::rpc_fault* why,
                  const std::vector<std::uint32_t>& strokes);

        service& owner;
        client_number to;
        bool batch = false;
        answer_handler answered = {}; ///< receives the only reply as values, not as text
        std::vector<place> places = {};
        std::size_t open = 0;
        std::vector<std::uint32_t> numbers = {}; ///< strokes to release after sending the replies
    };

    /// Counts at the time when a request arrived: stops of everything, and cancellations of all strokes of a
    /// client.
    struct stop_mark {
        std::uint64_t stops = 0;
        std::shared_ptr<const std::uint64_t> cancels = {};
        std::uint64_t own = 0;
    };

    /// Destination of a result. This is a reply, a place in a batch of replies, or no reply.
    struct answer {
        std::shared_ptr<pending> all;
        std::size_t at = 0;
        stop_mark since = {};

        /// Sends a result. `strokes` are new strokes, whose notifications may be sent from now on.
        void send_result(const reply_json& r, const std::vector<std::uint32_t>& strokes = {}) const;
        /// Returns the text of a reply. `result` is a result that is already JSON text on one line. Any
        /// thread.
        std::string format_reply(std::string_view result) const;
        /// Sends a reply from format_reply(). If `file` is true, the reply may exceed the limit of waiting
        /// bytes.
        void send_reply(std::string reply, bool file) const;
        void send_fault(const net::rpc_fault& f) const;
    };

    struct plan_job {
        answer to;
        std::string method; ///< "play", "plan", "import" or "export"
        std::size_t bytes = 0;
        net::json params = {}; ///< freed after planning
        options::option_values values =
            {}; ///< for play and plan: the owner's options with those of the request
        net::json start = "now";
        double gain_db = 0.0;     ///< gain of all strokes of the request
        std::uint64_t rounds = 1; ///< number of rounds; 0 means until cancelled
        double round_s = 0.0;     ///< smallest length of a round
        double pause_s = 0.0;     ///< silence after each round
        bool held = false;        ///< true if strokes end with the client's connection
        view_choice view = {};
        std::optional<double> draft = {};

        // Results of the work.
        std::shared_ptr<planned> made = {};
        std::vector<score> scores = {};
        std::string text = {};
        std::optional<net::rpc_fault> fault = {};

        bool plays() const { return method == "play"; }
        bool is_file() const { return method == "import" || method == "export"; }
    };

    // Members defined in service.cpp:
    bool receive(client_number number, net::rpc_message& m, std::size_t bytes, const stop_mark& since,
                 answer_handler answered = {});
    void handle(client& c, net::rpc_request& r, const answer& to, std::size_t bytes);
    bool admitted(client& c, const net::rpc_message& m);
    /// Returns options of the stream with handlers that call this service.
    stream_options add_handlers(stream_options s);
    void schedule_memory_trim();

    // Members defined in service_methods.cpp:
    void hello(client& c, const net::json& params, const answer& to);
    void status(client& c, const net::json& params, const answer& to);
    void list_options(client& c, const net::json& params, const answer& to);
    void make_qr(client& c, const net::json& params, const answer& to);
    void send_stroke_event(stroke_record& r, std::string_view state, const stroke_report& how);
    void subscribe(client& c, const net::json& params, const answer& to);
    reply_json hello_result(const client& c);
    reply_json limits_json() const;
    void touch(stroke_record& r);
    void send_touch_event(const stroke_record& r, bool down);

    // Members defined in service_jobs.cpp:
    void add_job(client& c, net::rpc_request& r, const answer& to, std::size_t bytes);
    void read_job(plan_job& j) const;
    void run_job(plan_job& j);
    std::string make_result_text(const plan_job& j, const go_on_check& go_on);
    void make_scores(plan_job& j, const go_on_check& go_on);
    bool has_room_for(std::size_t bytes) const;
    void finish_job(const std::shared_ptr<plan_job>& j);
    void refuse(const plan_job& j, const net::rpc_fault& f);
    void forget(const plan_job& j);
    void remove_from_counts(const plan_job& j);
    void submit_all(const plan_job& job);
    std::uint64_t count_rounds(const plan_job& job, const planned& p) const;

    // Members defined in service_strokes.cpp:
    void drive(client& c, const net::json& params, const answer& to);
    std::vector<std::uint32_t> submit(client_number owner, const net::json& start, const planned& p,
                                      const std::vector<score>& scores, const char* ended_by,
                                      double gain_db = 0.0, bool again = false);
    void submit_next(stroke_record& r);
    void check_free_place(const client& c) const;
    std::vector<std::uint32_t> end_stopped_strokes(client_number owner, std::size_t n, const char* why);
    void run_when_ready(const answer& to, const char* source, std::function<void()> then);
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
    void begin_live_stroke(client& c, const live_options& o, double intensity_max, const answer& to);
    void to(client& c, const net::json& params, const answer& to);
    void end(client& c, const net::json& params, const answer& to);
    stroke_record& find_own_stroke(const client& c, std::uint32_t number);
    stroke_record& find_own_live_stroke(client& c, std::uint32_t number);

    stroke_record& add_record(client_number owner);
    void handle_begin(std::uint64_t player, stroke_id id, std::optional<std::int64_t> at_ns);
    void handle_end(std::uint64_t player, const stroke_report& r);
    void start_followers(stroke_record& first, std::int64_t at_ns);
    void note_beginning(stroke_record& r, stroke_id id);
    void end_rounds(stroke_record& r);
    std::vector<stroke_record*> find_request_strokes(const stroke_record& r);
    std::optional<std::uint64_t> end_request(const stroke_record& of);
    std::uint64_t end_requests(client_number owner, const std::vector<std::uint32_t>& numbers);
    void add_submission(stroke_record& r, stroke_id id);
    void finish(stroke_record& r, const stroke_report& how);
    std::string reason(const stroke_record& r, const stroke_report& how) const;
    static void set_log_details(stroke_record& r, std::string_view name, const render_options& o);
    std::string describe_for_log(const stroke_record& r);
    const char* stop_reason(client_number owner) const;
    stop_mark mark(const client& c) const;
    const char* stop_reason_since(const answer& to) const;
    void update_busy();

    boost::asio::io_context& io_;
    boost::asio::steady_timer quiet_; ///< expires 500 ms after the last large message
    service_options options_;
    layout faces_;
    stream stream_;
    client_list clients_{io_, options_, stream_.peaks()};
    std::map<std::uint32_t, stroke_record> strokes_;
    std::map<std::pair<std::uint64_t, stroke_id>, std::uint32_t> by_player_;
    std::uint32_t last_stroke_ = 0;
    std::uint64_t stops_ = 0;
    client_number stopped_by_ = 0; ///< client that last stopped everything
    boost::asio::steady_timer touch_timer_;
    std::set<std::uint32_t> touches_due_ = {}; ///< live strokes with a touch that is not yet sent
    allowance touches_ = {};
    std::size_t jobs_ = 0;            ///< number of jobs that wait for planning or are being planned
    std::atomic<bool> ending_{false}; ///< planner threads also check this between strokes
    std::function<void()> stopped_;
    planners planners_{io_};
};

} // namespace tactor::server
