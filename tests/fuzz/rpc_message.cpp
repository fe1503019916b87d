// SPDX-License-Identifier: MIT
// Sends messages of JSON-RPC, as lines, to a whole service on a device without sound. Each request gets one
// answer, in the form of the standard and with a reason, each stroke that began ends once, and nothing stays
// behind. One service serves all inputs: in each of them, "stroke":1 is the first stroke of that input. An
// empty line waits for all answers and then lets some periods of the device pass. A line that begins with "!"
// is a message of a program of the older bHaptics protocol.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <poll.h>

#include <tactor/array.hpp>
#include <tactor/sink.hpp>

#include "holds.hpp"
#include "rt/event_fd.hpp"
#include "server/bhaptics.hpp"
#include "server/service.hpp"

using namespace tactor;
using net::json;

namespace {

constexpr unsigned channels = 9;
constexpr unsigned rate = 48000;
constexpr unsigned period_frames = 192;

// Limits that an input of 4 kB can reach. They keep the time of a plan to milliseconds.
server::service_limits small_limits()
{
    server::service_limits l;
    l.max_strokes = 8;
    l.max_live_strokes = 2;
    l.max_points_per_s = 16.0;
    l.max_stroke_s = 10.0;
    l.max_nesting = 16;
    return l;
}

/// The clock of a DAC without a device. It begins at 1000 s, and goes on only when the fuzzer moves it.
struct stepped_clock {
    /// Plays one period, and blocks until the audio thread has written the next one and reported.
    void step()
    {
        const std::uint64_t next = due.load() + setup.period_frames;
        due.store(next, std::memory_order_release);
        moved.signal();
        for (std::uint64_t now = seen.load(); now < next; now = seen.load())
            seen.wait(now);
    }
    std::int64_t time_ns(std::uint64_t frames) const noexcept
    {
        constexpr std::int64_t begin_ns = 1'000'000'000'000;
        return begin_ns + static_cast<std::int64_t>(1'000'000'000 * frames / setup.rate);
    }
    /// Returns the time that the sink's positions have, ns. Any thread may call it.
    std::int64_t now_ns() const noexcept { return time_ns(due.load(std::memory_order_acquire)); }

    stream_setup setup;
    std::atomic<std::uint64_t> due{0};  ///< frames that the DAC may have played
    std::atomic<std::uint64_t> seen{0}; ///< `due` as the audio thread last handled it
    rt::event_fd moved = {};
};

/// The DAC, which plays by a clock.
class stepped_sink final : public sink {
public:
    explicit stepped_sink(stepped_clock& c) : clock_(c) {}

    const stream_setup& setup() const noexcept override { return clock_.setup; }
    io_kind prepare() noexcept override
    {
        from_ = looked_;
        written_ = 0;
        return io_kind::ok;
    }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }

    std::size_t max_descriptors() const noexcept override { return 1; }
    std::size_t descriptors(std::span<pollfd> fds) noexcept override
    {
        // The audio thread has published everything of its last wake-up.
        clock_.seen.store(looked_, std::memory_order_release);
        clock_.seen.notify_one();
        fds[0] = {.fd = clock_.moved.fd(), .events = POLLIN, .revents = 0};
        return 1;
    }
    io_kind ready(std::span<pollfd>) noexcept override
    {
        clock_.moved.consume();
        return room() >= clock_.setup.period_frames ? io_kind::ok : io_kind::again;
    }

    io_result available() noexcept override { return {io_kind::ok, static_cast<std::size_t>(room()), 0}; }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const std::size_t n = std::min<std::size_t>(frames.size() / clock_.setup.frame_bytes(),
                                                    static_cast<std::size_t>(room()));
        written_ += n;
        return {n == 0 ? io_kind::again : io_kind::ok, n, 0};
    }
    stream_position position() noexcept override
    {
        looked_ = clock_.due.load(std::memory_order_acquire);
        return {written_, played(looked_), clock_.time_ns(looked_), true};
    }
    void drop() noexcept override {}

private:
    // A DAC without frames waits for more, so there are no xruns.
    std::uint64_t played(std::uint64_t due) const noexcept { return std::min(due - from_, written_); }
    std::uint64_t room() const noexcept
    {
        return clock_.setup.buffer_frames - (written_ - played(clock_.due.load(std::memory_order_acquire)));
    }

    stepped_clock& clock_;
    std::uint64_t from_ = 0;    ///< `due` at the epoch's start
    std::uint64_t looked_ = 0;  ///< `due` of the last position
    std::uint64_t written_ = 0; ///< in this epoch
};

// Checks the messages to a client against the protocol.
class listener final : public server::client_link {
public:
    void send(std::string message) override
    {
        const json all = json::parse(message);
        for (const json& m : all.is_array() ? all : json::array({all}))
            take(m);
    }
    std::size_t queued_bytes() const override { return 0; }
    void finish() override {}

    /// Notes which answers a message needs.
    void ask(std::string_view text)
    {
        for (const auto& part : net::parse_rpc(text, small_limits().max_nesting).parts)
            if (const auto* r = std::get_if<net::rpc_request>(&part); r == nullptr)
                owed_.push_back(std::get<net::rpc_refusal>(part).id);
            else if (r->wants_reply)
                owed_.push_back(r->id);
    }
    /// Forgets the strokes that have ended.
    void forget() { over_.clear(); }

    bool is_owed() const { return !owed_.empty(); }
    bool is_playing() const { return !going_.empty(); }
    /// The greatest number of a stroke.
    int newest() const { return newest_; }

private:
    void take(const json& m)
    {
        HOLDS(m["jsonrpc"] == "2.0");
        if (m.contains("method"))
            return m["method"] == "stroke" ? stroke(m["params"]) : void();
        HOLDS(m.contains("id") && m.contains("result") != m.contains("error"));
        const auto asked = std::find(owed_.begin(), owed_.end(), m["id"]);
        HOLDS(asked != owed_.end());
        owed_.erase(asked);
        if (m.contains("error")) {
            static const std::set<int> codes{-32700, -32600, -32601, -32602, -32000, -32001, -32002};
            HOLDS(codes.contains(m["error"]["code"].get<int>()));
            const json& d = m["error"]["data"];
            HOLDS(d.size() == 4 + d.count("line") + d.count("column")); // kind, what, why and hint
            HOLDS(!d["what"].get<std::string>().empty() && !d["why"].get<std::string>().empty());
        } else if (const auto n = m["result"].find("stroke"); n != m["result"].end()) {
            const json& r = m["result"];
            for (const json& one : r.contains("strokes") ? r["strokes"] : json::array({*n}))
                HOLDS(going_.insert(one.get<int>()).second);
        }
    }
    void stroke(const json& p)
    {
        // A client that asks without an id learns the number from this.
        const int n = p["stroke"].get<int>();
        HOLDS(!over_.contains(n));
        newest_ = std::max(newest_, n);
        going_.insert(n);
        if (p["state"] != "started") {
            going_.erase(n);
            over_.insert(n);
        }
    }

    std::vector<json> owed_; ///< ids
    std::set<int> over_;
    std::set<int> going_;
    int newest_ = 0;
};

// The connection of a program, which gets nothing but its status.
class program_link final : public server::client_link {
public:
    void send(std::string message) override { HOLDS(json::parse(message).contains("ActiveKeys")); }
    std::size_t queued_bytes() const override { return 0; }
    void finish() override {}
};

// Adds `base` to each number of a stroke that is an integer of at most two digits.
std::string with_strokes_from(std::string_view line, int base)
{
    constexpr std::string_view key = "\"stroke\":";
    std::string out;
    for (std::size_t at = line.find(key); at != line.npos; at = line.find(key)) {
        out += line.substr(0, at + key.size());
        line.remove_prefix(at + key.size());
        const std::size_t digits = std::min(line.find_first_not_of("0123456789"), line.size());
        const bool whole =
            digits == line.size() || (line[digits] != '.' && line[digits] != 'e' && line[digits] != 'E');
        if (!whole || digits == 0 || digits > 2)
            continue;
        out += std::to_string(base + std::stoi(std::string(line.substr(0, digits))));
        line.remove_prefix(digits);
    }
    return out += line;
}

class rig {
public:
    rig()
    {
        server::service_options o;
        o.plans.tactors = preset_array("palm-3x3");
        o.plans.owner.render.channels = channels;
        o.plans.owner.render.rate = rate;
        o.limits = small_limits();
        o.plans.max_stroke_s = o.limits.max_stroke_s;
        o.plans.max_strokes = o.limits.max_strokes;
        o.version = "fuzz";
        o.plan_text = [](const server::planned& p, std::size_t) { return json(p.name).dump(); };
        o.now_ns = [this] { return clock_.now_ns(); };
        server::stream_options s;
        s.tactors = o.plans.tactors;
        s.player.realtime = false;
        s.player.fade_s = 0.001;
        s.player.stall_s = 600.0; // the clock stands still between inputs
        // Strokes drive the array nearly always: the limits would mute it after some seconds.
        s.player.limits.max_drive_s = 3600.0;
        s.player.limits.window_s = 3600.0;
        s.wished.channels = channels;
        s.wished.rate = rate;
        s.open = [this] { return std::make_unique<stepped_sink>(clock_); };
        all_ = std::make_unique<server::service>(io_, std::move(o), std::move(s));
        all_->start();
        bool ready = false;
        all_->output().call_when_ready([&] { ready = true; });
        while (!ready)
            io_.run_one();
        watcher_ = all_->connect(seen_, server::client_kind::local);
        send_as_watcher(
            R"({"jsonrpc":"2.0","method":"subscribe","params":{"events":["strokes","levels","stream","touches","stops"],"levels_hz":5}})");
    }

    void take(std::string_view lines)
    {
        const auto box = std::make_shared<listener>();
        const server::client_number c = all_->connect(box, server::client_kind::local);
        const int first = seen_->newest();
        const auto program = std::make_shared<server::bhaptics_program>(
            io_, *all_, std::make_shared<program_link>(), small_limits().max_nesting);
        const server::client_number p = all_->connect(program, server::client_kind::bhaptics);
        program->begin(p);
        for (std::size_t from = 0; from < lines.size();) {
            const std::size_t end = std::min(lines.find('\n', from), lines.size());
            if (end == from)
                settle(*box);
            else if (lines[from] == '!')
                program->receive(std::string(lines.substr(from + 1, end - from - 1)));
            else
                send(c, *box, with_strokes_from(lines.substr(from, end - from), first));
            from = end + 1;
        }
        settle(*box);
        send_as_watcher(R"({"jsonrpc":"2.0","method":"stop"})");
        for (int steps = 0; !all_->input_ended(c) || seen_->is_playing(); ++steps) {
            step(steps);
            if (steps == most_steps_to_end)
                tell_what_hangs(c);
        }
        HOLDS(!box->is_owed() && !box->is_playing());
        all_->disconnect(c);
        all_->disconnect(p);
        seen_->forget();
        if (++inputs_ % inputs_a_look == 0)
            look();
    }

private:
    static constexpr unsigned inputs_a_look = 64; // a look takes as long as a short message
    // Each is 4 ms of the device's time, and at least 1 ms of other threads' time.
    static constexpr int most_steps_to_end = 20'000;

    void tell_what_hangs(server::client_number c)
    {
        std::cerr << "no end of " << (all_->input_ended(c) ? "strokes" : "messages") << ": "
                  << all_->status_json().dump() << '\n';
        HOLDS(false);
    }

    void send(server::client_number c, listener& box, const std::string& line)
    {
        box.ask(line);
        HOLDS(all_->receive(c, line));
        io_.poll();
    }
    void send_as_watcher(std::string_view line)
    {
        HOLDS(all_->receive(watcher_, line));
        io_.poll();
    }

    // Waits for all answers, then lets time pass while strokes go on, for a few periods at most.
    void settle(const listener& box)
    {
        constexpr int most_steps = 8;
        while (box.is_owed())
            io_.run_one();
        for (int i = 0; i < most_steps && (box.is_playing() || seen_->is_playing()); ++i)
            step(i);
    }

    // Runs the handlers that wait or, if there are none, plays a period. After many steps another thread
    // probably needs this processor: then this thread sleeps.
    void step(int steps)
    {
        constexpr int usual_steps = 8;
        if (io_.poll() != 0)
            return;
        clock_.step();
        if (steps >= usual_steps)
            io_.run_one_for(std::chrono::milliseconds(1));
    }

    void look()
    {
        const auto now = all_->status_json();
        HOLDS(now["clients"] == 1);
        HOLDS(now["strokes"].empty());
        HOLDS(now["stream"]["state"] == "running");
    }

    stepped_clock clock_{{.name = "nobody",
                          .channels = channels,
                          .rate = rate,
                          .period_frames = period_frames,
                          .buffer_frames = 2 * period_frames}};
    boost::asio::io_context io_;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    std::shared_ptr<listener> seen_ = std::make_shared<listener>(); ///< messages to the watcher
    server::client_number watcher_ = 0; ///< a client that stays, and stops each input's strokes
    std::unique_ptr<server::service> all_;
    unsigned inputs_ = 0;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    // Never destroyed: at exit, static tables of the library go before the threads that read them.
    static rig& one = *new rig; // NOLINT(cppcoreguidelines-owning-memory)
    one.take(fuzz::as_text(data, size));
    return 0;
}
