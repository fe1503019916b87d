// SPDX-License-Identifier: MIT
/// \file
/// The service with fake DACs in place of a card, and clients that are lists of messages.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/array.hpp>
#include <tactor/error.hpp>

#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "rt/clock.hpp"
#include "server/service.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace tactor::test {

using net::json;
using server::client_number;

/// Messages to one client.
class inbox final : public server::client_link {
public:
    void send(std::string message) override { all.push_back(json::parse(message)); }
    std::size_t queued_bytes() const override { return unread; }
    std::size_t file_bytes() const override { return file_bytes_unread; }
    void finish() override { finished = true; }

    /// Returns the parameters of the notifications of one kind, in order.
    std::vector<json> notifications(const std::string& method) const
    {
        std::vector<json> found;
        for (const json& m : all)
            if (m.is_object() && m.value("method", "") == method)
                found.push_back(m["params"]);
        return found;
    }
    /// Returns those of a stroke.
    std::vector<json> stroke_messages(const json& number) const
    {
        std::vector<json> found = notifications("stroke");
        std::erase_if(found, [&](const json& m) { return m["stroke"] != number; });
        return found;
    }
    std::optional<json> find_end(const json& number) const
    {
        for (const json& m : stroke_messages(number))
            if (m["state"] != "started")
                return m;
        return std::nullopt;
    }
    std::optional<json> reply(int id) const
    {
        for (const json& m : all)
            if (m.is_object() && m.contains("id") && m["id"] == id)
                return m;
        return std::nullopt;
    }
    std::vector<std::string> streams() const
    {
        std::vector<std::string> states;
        for (const json& m : notifications("stream"))
            states.push_back(m["state"]);
        return states;
    }

    std::vector<json> all;
    std::size_t unread = 0;
    std::size_t file_bytes_unread = 0; ///< of files that wait to be read
    bool finished = false;
};

class service_rig {
public:
    using changes = std::function<void(server::service_options&, server::stream_options&)>;

    explicit service_rig(const changes& change = {})
    {
        server::service_options o;
        o.plans.tactors = preset_array("palm-3x3");
        o.plans.owner.render.channels = 9;
        o.version = "test";
        o.limits.max_stroke_s = 86400.0; // of a clock that runs as fast as it can
        o.plan_text = [](const server::planned& p, std::size_t) { return "{\"name\":\"" + p.name + "\"}"; };
        o.now_ns = rt::monotonic_ns;
        server::stream_options s;
        s.tactors = o.plans.tactors;
        for (tactor_spec& t : s.tactors.tactors)
            t.max_dbfs = -12.0;
        s.player = patient();
        s.player.realtime = false;
        s.player.limits.max_drive_s = 3600.0; // the clock runs as fast as it can
        s.player.limits.window_s = 3600.0;
        s.wished.channels = 9;
        s.wished.rate = 48000;
        s.times.retry_s = 0.001;
        s.times.proof_s = 0.01;
        s.open = [this] { return open(); };
        if (change)
            change(o, s);
        all.emplace(io, std::move(o), std::move(s));
    }
    ~service_rig()
    {
        if (!closed)
            close();
        all.reset();
    }

    /// A new card in place of the last.
    fake_dac& plug()
    {
        const std::lock_guard lock(mutex);
        cards.emplace_back();
        here = true;
        return cards.back();
    }
    /// Waits until the stream is closed because nobody draws, and gives the next one a new card.
    void sleep_and_plug()
    {
        until([this] { return all->output().state() == server::stream_state::idle; });
        until([this] { return cards.back().closed(); });
        clocks.clear();
        plug();
    }
    void unplug()
    {
        const std::lock_guard lock(mutex);
        here = false;
        clocks.clear();
        cards.back().disconnect();
    }

    struct connected {
        client_number number;
        std::shared_ptr<inbox> box;
    };
    connected client(server::client_kind k = server::client_kind::local)
    {
        auto box = std::make_shared<inbox>();
        return {all->connect(box, k, "192.168.1.7"), box}; // a local one has no address
    }
    bool send(const connected& c, const json& message) { return all->receive(c.number, message.dump()); }
    /// A request; call() counts its ids from 1.
    static json request(int id, const std::string& method, const json& params = json::object())
    {
        return {{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}};
    }
    /// Waits for the answer to a request.
    json reply(const connected& c, int id)
    {
        until([&] { return c.box->reply(id).has_value(); });
        return *c.box->reply(id);
    }
    /// A request and its answer.
    json call(const connected& c, const std::string& method, const json& params = json::object())
    {
        send(c, request(++last_id, method, params));
        return reply(c, last_id);
    }
    json ok(const connected& c, const std::string& method, const json& params = json::object())
    {
        const json r = call(c, method, params);
        REQUIRE_MESSAGE(r.contains("result"), r.dump());
        return r["result"];
    }
    int code(const connected& c, const std::string& method, const json& params = json::object())
    {
        const json r = call(c, method, params);
        return r.contains("error") ? r["error"]["code"].get<int>() : 0;
    }
    json find_end(const connected& c, const json& number)
    {
        until([&] { return c.box->find_end(number).has_value(); });
        return *c.box->find_end(number);
    }
    template <typename Condition>
    void until(Condition c)
    {
        while (!c())
            io.run_one();
    }
    void start()
    {
        all->start();
        until([&] { return all->output().state() != server::stream_state::lost || !is_here(); });
    }
    void close()
    {
        closed = false;
        all->close([this] { closed = true; });
        until([&] { return closed; });
        // Handlers behind it in the queue.
        io.poll();
    }

    boost::asio::io_context io;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
    std::optional<server::service> all;
    std::list<fake_dac> cards;
    std::list<running_clock> clocks; ///< of the last card; ends before it
    running_clock::capture_kind captures = running_clock::capture_kind::dropped; ///< of the next card
    alsa_options buffer = {};                                                    ///< periods of the next card
    bool closed = false;

private:
    bool is_here()
    {
        const std::lock_guard lock(mutex);
        return here;
    }
    std::unique_ptr<sink> open()
    {
        const std::lock_guard lock(mutex);
        if (!here)
            throw error(error_kind::not_available, "card", "it is not there");
        fake_dac& card = cards.back();
        alsa_options o = buffer;
        o.channels = 9;
        o.format = format_kind::s32;
        std::unique_ptr<sink> s = alsa::adopt(card.pcm(), o);
        clocks.emplace_back(card, captures);
        return s;
    }

    std::mutex mutex;
    bool here = false;
    int last_id = 0;
};

/// A service with a card, whose stream runs.
class running_rig : public service_rig {
public:
    explicit running_rig(const changes& change = {}) : service_rig(change)
    {
        plug();
        start();
    }
};

} // namespace tactor::test
