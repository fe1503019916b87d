// SPDX-License-Identifier: MIT
// Messages of JSON-RPC, as lines, to a whole service with a device that plays to nobody: every answer is one
// of the standard's and in words, every stroke that began has one end, and nothing stays.
#include <chrono>
#include <cstdlib>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include <tactor/array.hpp>
#include <tactor/sink.hpp>

#include "holds.hpp"
#include "server/service.hpp"

using namespace tactor;
using net::json;

namespace {

// Fast, so that strokes are soon over.
constexpr unsigned rate = 384000;

class nobody final : public paced_sink {
public:
    nobody() : paced_sink({.name = "nobody", .channels = 9, .rate = rate, .period_frames = 192}) {}

protected:
    io_kind take(std::uint64_t, std::span<const std::byte>) noexcept override { return io_kind::ok; }
};

// Holds what it is told against the protocol.
class listener final : public server::client_link {
public:
    void send(std::string message) override
    {
        const json all = json::parse(message);
        for (const json& m : all.is_array() ? all : json::array({all}))
            take(m);
    }
    std::size_t waiting() const override { return 0; }
    void finish() override {}

    bool ended() const { return going_.empty(); }

private:
    void take(const json& m)
    {
        HOLDS(m["jsonrpc"] == "2.0");
        if (m.contains("method"))
            return m["method"] == "stroke" ? stroke(m["params"]) : void();
        HOLDS(m.contains("id") && m.contains("result") != m.contains("error"));
        if (m.contains("error")) {
            static const std::set<int> codes{-32700, -32600, -32601, -32602, -32000, -32001, -32002};
            HOLDS(codes.contains(m["error"]["code"].get<int>()));
            const json& d = m["error"]["data"];
            HOLDS(d.size() == 4 && !d["what"].get<std::string>().empty() &&
                  !d["why"].get<std::string>().empty());
        } else if (const auto n = m["result"].find("stroke"); n != m["result"].end()) {
            const json& r = m["result"];
            for (const json& one : r.contains("strokes") ? r["strokes"] : json::array({*n}))
                HOLDS(going_.insert(one.get<int>()).second);
        }
    }
    void stroke(const json& p)
    {
        // Whoever asked without an id learns the number from this.
        const int n = p["stroke"].get<int>();
        HOLDS(!over_.contains(n));
        going_.insert(n);
        if (p["state"] != "started") {
            going_.erase(n);
            over_.insert(n);
        }
    }

    std::set<int> over_;
    std::set<int> going_;
};

class quiet final : public server::client_link {
public:
    void send(std::string) override {}
    std::size_t waiting() const override { return 0; }
    void finish() override {}
};

class rig {
public:
    rig()
    {
        server::service_options o;
        o.plans.tactors = preset_array("palm-3x3");
        o.plans.owner.render.channels = 9;
        o.plans.owner.render.rate = rate;
        o.version = "fuzz";
        o.plan_text = [](const server::planned& p, std::size_t) { return json(p.name).dump(); };
        o.now_ns = [] {
            return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
        };
        server::stream_options s;
        s.tactors = o.plans.tactors;
        s.player.realtime = false;
        s.player.fade_s = 0.001;
        s.wished.channels = 9;
        s.wished.rate = rate;
        s.open = [] { return std::make_unique<nobody>(); };
        all_ = std::make_unique<server::service>(io_, std::move(o), std::move(s));
        all_->start();
        bool ready = false;
        all_->output().when_ready([&] { ready = true; });
        while (!ready)
            io_.run_one();
    }

    void take(std::string_view lines)
    {
        const auto box = std::make_shared<listener>();
        const server::client_number c = all_->connect(box, server::client_kind::local);
        for (std::size_t from = 0; from < lines.size();) {
            const std::size_t end = std::min(lines.find('\n', from), lines.size());
            if (end != from)
                HOLDS(all_->receive(c, lines.substr(from, end - from)));
            from = end + 1;
            io_.poll();
        }
        // Whatever goes on is stopped, and then there is an end.
        const server::client_number other =
            all_->connect(std::make_shared<quiet>(), server::client_kind::local);
        all_->receive(other, R"({"jsonrpc":"2.0","method":"stop"})");
        all_->disconnect(other);
        going_.push_back({c, box});
        end(most_going);
    }

    ~rig()
    {
        end(0);
        HOLDS(all_->status_now()["clients"] == 0);
        HOLDS(all_->status_now()["strokes"].empty());
    }

private:
    struct client {
        server::client_number number;
        std::shared_ptr<listener> box;
    };

    // The stream takes milliseconds to fade: inputs that follow are handled meanwhile. So what is found may
    // be of one of the last inputs: TACTOR_FUZZ_ALONE=1 has one end before the next.
    const std::size_t most_going = std::getenv("TACTOR_FUZZ_ALONE") != nullptr ? 0 : 64;

    // Waits until no more than so many inputs go on.
    void end(std::size_t most)
    {
        for (;;) {
            std::erase_if(going_, [this](const client& c) {
                if (!all_->input_ended(c.number))
                    return false;
                HOLDS(c.box->ended());
                all_->disconnect(c.number);
                return true;
            });
            if (going_.size() <= most)
                return;
            io_.run_one();
        }
    }

    std::vector<client> going_;
    boost::asio::io_context io_;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    std::unique_ptr<server::service> all_;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    static rig one;
    one.take(fuzz::text_of(data, size));
    return 0;
}
