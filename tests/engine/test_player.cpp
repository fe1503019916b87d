// SPDX-License-Identifier: MIT
// The player with its real threads. Time is the fake DAC's; the tests wait for conditions.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/use_future.hpp>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <tactor/alsa.hpp>
#include <tactor/asio.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "core/owned.hpp"
#include "fake_dac.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "rt/clock.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace player_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Plays a period whenever the player has refilled the buffer, until the condition holds.
template <typename Condition>
void run_until(fake_dac& dac, std::uint64_t buffer, Condition done)
{
    while (!done()) {
        dac.await([&] { return done() || dac.queued() >= buffer || !dac.running(); });
        if (!done())
            dac.advance_queued(96);
    }
}

// Sink with a separate set-up, which changes with each start, like a PCM that turns out to have no clock.
class changing_sink final : public forwarding_sink {
public:
    explicit changing_sink(std::unique_ptr<sink> s)
        : forwarding_sink(std::move(s)), own(forwarding_sink::setup())
    {
    }
    const stream_setup& setup() const noexcept override { return own; }
    io_kind start() noexcept override
    {
        own.has_clock = !own.has_clock;
        return forwarding_sink::start();
    }

    stream_setup own;
};

// Edges through a pipe.
class pipe_edges : public edge_input {
public:
    pipe_edges()
    {
        std::array<int, 2> ends{};
        REQUIRE(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC) == 0);
        read_ = detail::owned_fd(ends[0]);
        write_ = detail::owned_fd(ends[1]);
    }
    int descriptor() const noexcept override { return read_.get(); }
    std::optional<gpio_edge> read() noexcept override
    {
        gpio_edge e;
        if (::read(read_.get(), &e.time_ns, sizeof e.time_ns) != sizeof e.time_ns)
            return std::nullopt;
        return e;
    }
    // Writes all at once.
    void edges(const std::vector<std::int64_t>& times_ns)
    {
        const std::size_t bytes = times_ns.size() * sizeof(std::int64_t);
        REQUIRE(::write(write_.get(), times_ns.data(), bytes) == static_cast<ssize_t>(bytes));
    }
    // Makes it readable for ever, without an edge.
    void break_off() { write_.close(); }

private:
    detail::owned_fd read_;
    detail::owned_fd write_;
};

} // namespace

TEST_CASE("with threads the bytes are the renderer's, and the report comes once")
{
    fake_dac dac;
    std::vector<stroke_report> told;
    std::mutex mutex;
    const score s = random_score(1, 8);
    {
        player p(alsa::adopt(dac.pcm(), nine()), palm(), patient());
        CHECK(p.setup().channels == 9);
        CHECK(p.setup().has_clock);
        p.on_report([&](const stroke_report& r) {
            const std::lock_guard lock(mutex);
            told.push_back(r);
        });
        const std::uint64_t from = dac.captured_frames();
        const stroke_id id = p.submit(s);
        run_until(dac, 288, [&] { return p.position().played >= from + s.frames() + 288; });
        const auto r = p.wait(id);
        REQUIRE(r);
        CHECK(r->state == state_kind::finished);
        CHECK(r->frames == s.frames());
        CHECK_FALSE(p.wait(id));
        CHECK(part(dac.captured(), from * 36, s.frames() * 36) == rendered(s, format_kind::s32));
        const running_clock clock(dac);
        p.stop();
        CHECK_FALSE(p.position().running);
        // Until the audio thread has ended, it may stand between a write and its count.
        CHECK(p.stats().frames == dac.captured_frames());
        CHECK(p.stats().periods * 96 == p.stats().frames);
        CHECK(p.stats().xruns == 0);
    }
    CHECK(dac.closed());
    REQUIRE(told.size() == 1);
    CHECK(told[0].state == state_kind::finished);
}

TEST_CASE("cancel and stop work from another thread than the waiting one")
{
    dac_player p;
    const stroke_id id = p.submit(tone(endless_s));
    const stroke_id other = p.submit(tone(endless_s, 3));
    const running_clock clock(p.dac);
    std::thread canceller([&] { CHECK(p.cancel(id)); });
    CHECK(p.wait(id)->state == state_kind::cancelled);
    canceller.join();
    CHECK_FALSE(p.cancel(id));
    std::thread stopper([&] { p.stop(); });
    CHECK(p.wait(other)->state == state_kind::cancelled);
    stopper.join();
    CHECK_THROWS_AS(p.submit(tone(0.1)), error);
    p.stop();
}

TEST_CASE("cancel_all ends strokes of all kinds, and the stream goes on")
{
    clocked_player p;
    std::vector<stroke_id> ids{p.submit(tone(endless_s)), p.submit(tone(1.0), start_at::trigger()),
                               p.submit(tone(1.0), start_at::frame(4'000'000'000)),
                               p.submit(tone(1.0), start_at::time(rt::to_time(INT64_MAX)))};
    const live_stroke drawn = p.begin({.timeout_s = 86400.0});
    ids.push_back(drawn.id());
    CHECK(p.cancel_all());
    for (const stroke_id id : ids) {
        CAPTURE(id.number);
        CHECK(p.wait(id)->state == state_kind::cancelled);
    }
    CHECK_FALSE(drawn.open());
    CHECK(p.cancel_all());
    CHECK(p.wait(p.submit(tone(0.1)))->state == state_kind::finished);
}

TEST_CASE("in a buffer of more than 0.4 s cancel_all ends the stream instead of waiting for its fade")
{
    fake_dac dac; // its clock stands still
    alsa_options o = nine();
    o.period_frames = 4800;
    o.periods = 5;
    player p(alsa::adopt(dac.pcm(), o), palm(), patient());
    const stroke_id sounding = p.submit(tone(endless_s));
    const stroke_id armed = p.submit(tone(1.0), start_at::trigger());
    CHECK_FALSE(p.cancel_all());
    CHECK_THROWS_AS(p.submit(tone(1.0)), error);
    CHECK_FALSE(p.cancel_all());
    CHECK(p.wait(sounding)->state == state_kind::cancelled);
    CHECK(p.wait(armed)->state == state_kind::cancelled);
    p.stop();
    CHECK(p.ended()->reason == reason_kind::none);
}

TEST_CASE("an unplugged device ends the waits and the stream")
{
    dac_player p;
    const stroke_id id = p.submit(tone(endless_s));
    p.dac.disconnect();
    CHECK(ending(*p.wait(id)) == "interrupted, lost: the device is gone");
    while (!p.ended()) // a stroke ends before its stream
        std::this_thread::yield();
    CHECK_THROWS_WITH_AS(p.submit(tone(0.1)), doctest::Contains("the device is gone"), error);
    p.stop();
}

TEST_CASE("a wait tells a time-out, a report taken before, and an unknown stroke apart")
{
    dac_player p;
    CHECK(p.wait({17}).outcome() == wait_kind::unknown);
    CHECK(p.wait({}).outcome() == wait_kind::unknown);
    const stroke_id id = p.submit(tone(endless_s));
    const wait_result none = p.wait(id, std::chrono::nanoseconds(1));
    CHECK(none.outcome() == wait_kind::timeout);
    CHECK_FALSE(none);
    CHECK(p.cancel(id));
    const running_clock clock(p.dac);
    const wait_result some = p.wait(id);
    CHECK(some.outcome() == wait_kind::ended);
    REQUIRE(some);
    CHECK((*some).id == id);
    CHECK(p.wait(id).outcome() == wait_kind::taken);
    CHECK(p.wait({id.number + 1}).outcome() == wait_kind::unknown);
    p.stop();
}

TEST_CASE("a level is set of a stroke that waits or sounds, and of no other")
{
    clocked_player p;
    const stroke_id id = p.submit(tone(0.05), start_at::trigger());
    CHECK(p.set_level(id, -6.0));
    CHECK_FALSE(p.set_level({77}, -6.0));
    CHECK_THROWS_AS(p.set_level(id, 0.1), error);
    p.fire(std::chrono::steady_clock::now());
    CHECK(p.wait(id));
    CHECK_FALSE(p.set_level(id, -6.0));
}

TEST_CASE("a device that does not start and a missing sink are errors")
{
    fake_dac broken;
    broken.fail_start(-EIO);
    CHECK_THROWS_WITH_AS(player(alsa::adopt(broken.pcm(), nine()), palm()),
                         doctest::Contains("it does not start (the device failed)"), error);
    CHECK(broken.closed());
    CHECK_THROWS_WITH_AS(player(nullptr, palm()), doctest::Contains("the sink is missing"), error);
}

TEST_CASE("a sink of one's own without rate, channels or periods is an error")
{
    for (const auto member : {&stream_setup::rate, &stream_setup::channels, &stream_setup::period_frames,
                              &stream_setup::buffer_frames}) {
        fake_dac dac;
        auto s = std::make_unique<changing_sink>(alsa::adopt(dac.pcm(), nine()));
        s->own.*member = 0;
        CHECK_THROWS_WITH_AS(player(std::move(s), palm()), doctest::Contains("its sink has"), error);
    }
}

TEST_CASE("a required real-time priority that is refused is an error; otherwise a note")
{
    player_options o = patient();
    o.require_realtime = true;
    bool realtime = true;
    try {
        const clocked_player p(o);
        CHECK(p.stats().realtime);
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::not_available);
        realtime = false;
    }
    const clocked_player p;
    CHECK(p.stats().realtime == realtime);
}

TEST_CASE("of too many reports not yet taken, the oldest ends go")
{
    dac_player p;
    const score s = tone(0.01);
    const stroke_id first = p.submit(s, start_at::trigger());
    const stroke_id second = p.submit(s, start_at::trigger());
    CHECK(p.cancel(second));
    for (int i = 0; i < 4096; ++i)
        REQUIRE(p.cancel(p.submit(s, start_at::trigger())));
    CHECK(p.cancel(first));
    CHECK(p.wait(first).outcome() == wait_kind::ended);
    CHECK(p.wait(second).outcome() == wait_kind::taken);
}

TEST_CASE("a player's set-up is that of the start, whatever the audio thread finds out later")
{
    fake_dac dac;
    auto changing = std::make_unique<changing_sink>(alsa::adopt(dac.pcm(), nine()));
    const stream_setup& own = changing->setup();
    player p(std::move(changing), palm(), patient());
    CHECK_FALSE(p.setup().has_clock);
    CHECK(&p.setup() != &own);
}

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
        CHECK_FALSE(p.wait(a, std::chrono::seconds(0)));
        const std::int64_t t = rt::monotonic_ns();
        trigger.edges({t, t + 1'000'000'000}); // the second has nothing left to start
        const auto ra = p.wait(a);
        const auto rb = p.wait(b);
        CHECK(ra->state == state_kind::finished);
        CHECK(rb->state == state_kind::finished);
        CHECK(ra->started_ns.has_value() == rb->started_ns.has_value());
    }
    const stroke_id c = p.submit(tone(0.01), start_at::trigger());
    trigger.break_off();
    const stroke_id d = p.submit(tone(0.01));
    CHECK(p.wait(d)->state == state_kind::finished);
    CHECK(p.fire(std::chrono::steady_clock::now()) == 1);
    CHECK(p.wait(c)->state == state_kind::finished);
    const stroke_id e = p.submit(tone(0.01), start_at::trigger());
    p.stop();
    CHECK(p.wait(e)->state == state_kind::cancelled);
    CHECK(p.fire(std::chrono::steady_clock::now()) == 0);
    CHECK_THROWS_AS(p.begin(), error);
}

TEST_CASE("edges at the ends of time fire or wait")
{
    player_lines lines;
    auto input = std::make_unique<pipe_edges>();
    pipe_edges& trigger = *input;
    lines.trigger = std::move(input);
    clocked_player p(patient(), std::move(lines));
    const stroke_id first = p.submit(tone(0.01), start_at::trigger());
    trigger.edges({INT64_MIN});
    CHECK(p.wait(first)->state == state_kind::finished);
    const stroke_id second = p.submit(tone(0.01), start_at::trigger());
    trigger.edges({INT64_MAX});
    p.stop();
    CHECK(p.wait(second)->state == state_kind::cancelled);
}

TEST_CASE("several producers of every kind at once: each stroke ends exactly once")
{
    std::vector<int> ends(2000, 0);
    stroke_id most;
    {
        std::mutex mutex;
        clocked_player p;
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
                                          : i % 4 == 1 ? start_at::time(rt::to_time(rt::monotonic_ns()))
                                          : i % 4 == 2 ? start_at::frame(p.position().played + 1000)
                                                       : start_at::trigger();
                    const stroke_id id = p.submit(tone(0.002, t), when);
                    if (i % 4 == 3)
                        p.fire(std::chrono::steady_clock::now());
                    if (i % 5 == 0)
                        p.cancel(id);
                    live_stroke own = p.begin({.timeout_s = 86400.0});
                    own.to(5.0, 5.0, 0.1);
                    if (i % 2 == 0)
                        own.end();
                    else
                        own.cancel();
                    CHECK(p.wait(id));
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
    std::optional<live_stroke> left;
    {
        clocked_player p;
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
    p.fire(std::chrono::steady_clock::now());
    await(calls, 2);
    CHECK(p.on_end(id, count)); // its report has not been taken
    CHECK(calls == 3);
    CHECK(p.wait(id));
    CHECK_FALSE(p.on_end(id, count));
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

} // namespace player_test
