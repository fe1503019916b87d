// SPDX-License-Identifier: MIT
// Live and armed strokes and completion handlers, with the player's real threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <ctime>
#include <exception>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <tactor/alsa.hpp>
#include <tactor/asio.hpp>
#include <tactor/error.hpp>

#include "clock_runner.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

namespace player_strokes_test {

using namespace tactor;
using namespace tactor::test;

namespace {

std::int64_t now_ns()
{
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

// Edges through a pipe.
class pipe_edges : public edge_input {
public:
    pipe_edges() { REQUIRE(::pipe2(fds_.data(), O_NONBLOCK | O_CLOEXEC) == 0); }
    ~pipe_edges() override
    {
        ::close(fds_[0]);
        if (fds_[1] >= 0)
            ::close(fds_[1]);
    }
    int descriptor() const noexcept override { return fds_[0]; }
    std::optional<gpio_edge> read() noexcept override
    {
        gpio_edge e;
        if (::read(fds_[0], &e.time_ns, sizeof e.time_ns) != sizeof e.time_ns)
            return std::nullopt;
        return e;
    }
    // Writes both at once.
    void edges(const std::array<std::int64_t, 2>& times_ns)
    {
        REQUIRE(::write(fds_[1], times_ns.data(), sizeof times_ns) == sizeof times_ns);
    }
    // Makes it readable for ever, without an edge.
    void break_off()
    {
        ::close(fds_[1]);
        fds_[1] = -1;
    }

private:
    std::array<int, 2> fds_{-1, -1};
};

} // namespace

TEST_CASE("an edge fires all armed strokes at once, at its time and the delay, and again")
{
    player_lines lines;
    auto input = std::make_unique<pipe_edges>();
    pipe_edges& trigger = *input;
    lines.trigger = std::move(input);
    lines.trigger_delay_s = 0.001;
    clocked_player p(patient(), std::move(lines));
    for (int round = 0; round < 5; ++round) {
        const stroke_id a = p.submit(tone(0.01), start_at::trigger());
        const stroke_id b = p.submit(tone(0.01, 3), start_at::trigger());
        CHECK_FALSE(p.wait(a, 0.0));
        const std::int64_t t = now_ns();
        trigger.edges({t, t + 1'000'000'000}); // the second has nothing left to start
        const auto ra = p.wait(a);
        const auto rb = p.wait(b);
        REQUIRE(ra);
        REQUIRE(rb);
        CHECK(ra->state == state_kind::finished);
        CHECK(rb->state == state_kind::finished);
        CHECK(ra->started_ns.has_value() == rb->started_ns.has_value());
    }
    const stroke_id c = p.submit(tone(0.01), start_at::trigger());
    trigger.break_off();
    const stroke_id d = p.submit(tone(0.01));
    CHECK(p.wait(d)->state == state_kind::finished);
    CHECK(p.fire(now_ns()) == 1);
    CHECK(p.wait(c)->state == state_kind::finished);
    const stroke_id e = p.submit(tone(0.01), start_at::trigger());
    p.stop();
    CHECK(p.wait(e)->state == state_kind::cancelled);
    CHECK(p.fire(now_ns()) == 0);
    CHECK_THROWS_AS(p.begin(), error);
}

TEST_CASE("several producers of every kind at once: each stroke ends exactly once")
{
    fake_dac dac;
    const running_clock clock(dac);
    std::vector<int> ends(2000, 0);
    stroke_id most;
    {
        player p(alsa::adopt(dac.pcm(), nine()), palm(), patient());
        std::mutex mutex;
        p.on_report([&](const stroke_report& r) {
            const std::lock_guard lock(mutex);
            ++ends.at(r.id.number);
            most = std::max(most, r.id);
        });
        live_stroke shared = p.begin({.timeout_s = 86400.0});
        std::vector<std::thread> threads;
        for (unsigned t = 0; t < 4; ++t) {
            threads.emplace_back([&, t] {
                for (unsigned i = 0; i < 40; ++i) {
                    shared.to(10.0 * t, 1.0 * i, 0.1);
                    const start_at when = i % 4 == 0   ? start_at::now()
                                          : i % 4 == 1 ? start_at::time(now_ns())
                                          : i % 4 == 2 ? start_at::frame(p.position().played + 1000)
                                                       : start_at::trigger();
                    const stroke_id id = p.submit(tone(0.002, t), when);
                    if (i % 4 == 3)
                        p.fire(now_ns());
                    if (i % 5 == 0)
                        p.cancel(id);
                    live_stroke own = p.begin({.timeout_s = 86400.0});
                    own.to(5.0, 5.0, 0.1);
                    if (i % 2 == 0)
                        own.end();
                    else
                        own.cancel();
                    p.wait(id);
                    CHECK(p.wait(own.id()));
                    CHECK_FALSE(own.to(1.0, 1.0));
                }
            });
        }
        for (std::thread& t : threads)
            t.join();
        shared.end();
        CHECK_FALSE(shared.open());
        const auto r = p.wait(shared.id());
        REQUIRE(r);
        CHECK(shared.counts().points <= 160);
        p.stop();
    }
    CHECK(most.number == 321);
    for (std::uint32_t n = 1; n <= most.number; ++n)
        REQUIRE(ends[n] == 1);
}

TEST_CASE("a live stroke outlives its player")
{
    fake_dac dac;
    const running_clock clock(dac);
    std::optional<live_stroke> left;
    {
        player p(alsa::adopt(dac.pcm(), nine()), palm(), patient());
        left = p.begin({.timeout_s = 86400.0});
        CHECK(left->to(1.0, 1.0));
    }
    CHECK_FALSE(left->to(2.0, 2.0));
    left->end();
    left->cancel();
    CHECK_FALSE(left->open());
    CHECK(left->counts().points == 1);
}

TEST_CASE("on_end works in time, late, for unknown strokes, and several times for one")
{
    clocked_player p;
    std::atomic<int> calls{0};
    const auto count = [&calls](const stroke_report& r) {
        CHECK(r.state == state_kind::finished);
        ++calls;
        calls.notify_all();
    };
    const stroke_id id = p.submit(tone(0.05), start_at::trigger());
    CHECK(p.on_end(id, count));
    CHECK(p.on_end(id, count));
    CHECK_FALSE(p.on_end({77}, count));
    p.fire(now_ns());
    for (int n = calls; n < 2; n = calls)
        calls.wait(n);
    CHECK(p.on_end(id, count)); // its report has not been taken
    CHECK(calls == 3);
    CHECK(p.wait(id));
    CHECK_FALSE(p.on_end(id, count));
}

TEST_CASE("Asio: callbacks in the caller's executor")
{
    clocked_player p;
    boost::asio::io_context context;
    const auto here = std::this_thread::get_id();
    std::vector<stroke_report> done;
    std::exception_ptr refused;
    const auto ran = [&](std::exception_ptr failed, const stroke_report& r) {
        CHECK(std::this_thread::get_id() == here);
        CHECK_FALSE(failed);
        done.push_back(r);
    };
    async_play(p, tone(0.01), start_at::now(), boost::asio::bind_executor(context, ran));
    const stroke_id id = p.submit(tone(endless_s));
    async_wait(p, id, boost::asio::bind_executor(context, ran));
    async_play(p, random_score(1, 1, 10), start_at::now(),
               boost::asio::bind_executor(
                   context, [&](std::exception_ptr failed, const stroke_report&) { refused = failed; }));
    CHECK_FALSE(refused); // never within the call
    p.cancel(id);
    context.run();
    REQUIRE(done.size() == 2);
    std::sort(done.begin(), done.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    CHECK(done[0].state == state_kind::finished);
    CHECK(done[1].state == state_kind::cancelled);
    REQUIRE(refused);
    CHECK_THROWS_AS(std::rethrow_exception(refused), error);
}

TEST_CASE("Asio: futures work, and an unknown stroke is an error")
{
    clocked_player p;
    std::future<stroke_report> a = async_play(p, tone(0.01), start_at::now(), boost::asio::use_future);
    std::future<stroke_report> b = async_wait(p, stroke_id{99}, boost::asio::use_future);
    CHECK(a.get().state == state_kind::finished);
    CHECK_THROWS_AS(b.get(), error);
    std::future<stroke_report> c =
        async_play(p, tone(endless_s), start_at::trigger(), boost::asio::use_future);
    p.stop();
    CHECK(c.get().state == state_kind::cancelled);
}

} // namespace player_strokes_test
