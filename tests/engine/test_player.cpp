// SPDX-License-Identifier: MIT
// The player with its real threads. Time is the fake DAC's; the tests wait for conditions.
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

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
    const auto r = p.wait(id);
    canceller.join();
    REQUIRE(r);
    CHECK(r->state == state_kind::cancelled);
    CHECK_FALSE(p.cancel(id));
    std::thread stopper([&] { p.stop(); });
    const auto o = p.wait(other);
    stopper.join();
    REQUIRE(o);
    CHECK(o->state == state_kind::cancelled);
    CHECK_THROWS_AS(p.submit(tone(0.1)), error);
    p.stop();
}

TEST_CASE("cancel_all ends strokes of all kinds, and the stream goes on")
{
    clocked_player p;
    std::vector<stroke_id> ids{p.submit(tone(endless_s)), p.submit(tone(1.0), start_at::trigger()),
                               p.submit(tone(1.0), start_at::frame(4'000'000'000)),
                               p.submit(tone(1.0), start_at::time(INT64_MAX))};
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

TEST_CASE("a player destroyed while strokes sound reports them as interrupted")
{
    fake_dac dac;
    const running_clock clock(dac);
    std::vector<stroke_report> told;
    {
        player p(alsa::adopt(dac.pcm(), nine()), palm(), patient());
        p.on_report([&](const stroke_report& r) { told.push_back(r); });
        p.submit(tone(endless_s));
        p.submit(tone(endless_s), start_at::frame(4'000'000'000));
    }
    REQUIRE(told.size() == 2);
    for (const stroke_report& r : told) {
        CHECK(r.state == state_kind::interrupted);
        CHECK(r.why == "the player was closed");
        CHECK(r.reason == reason_kind::closed);
    }
    CHECK(dac.closed());
}

TEST_CASE("a handler may submit, cancel and stop, and never waits for itself")
{
    std::atomic<int> rounds{0};
    std::atomic<stroke_id> last{stroke_id{}};
    clocked_player p;
    p.on_report([&](const stroke_report& r) {
        if (rounds++ < 5) {
            last = p.submit(tone(0.01));
            CHECK(p.wait(last).outcome() == wait_kind::timeout);
            CHECK_FALSE(p.cancel(r.id));
        } else {
            p.stop();
        }
        rounds.notify_all();
    });
    p.submit(tone(0.01));
    for (int n = rounds; n < 6; n = rounds)
        rounds.wait(n);
    p.stop();
    CHECK(rounds == 6);
}

TEST_CASE("several producers: every stroke ends once")
{
    clocked_player p;
    std::atomic<int> finished{0};
    std::vector<std::thread> producers;
    for (unsigned t = 0; t < 4; ++t) {
        producers.emplace_back([&, t] {
            for (int i = 0; i < 25; ++i) {
                const auto r = p.wait(p.submit(tone(0.002, t)));
                finished += static_cast<int>(r && r->state == state_kind::finished);
            }
        });
    }
    for (std::thread& t : producers)
        t.join();
    CHECK(finished == 100);
}

TEST_CASE("an unplugged device ends the waits and the stream")
{
    dac_player p;
    const stroke_id id = p.submit(tone(endless_s));
    p.dac.disconnect();
    const auto r = p.wait(id);
    REQUIRE(r);
    CHECK(r->state == state_kind::interrupted);
    CHECK(r->why == "the device is gone");
    CHECK(r->reason == reason_kind::lost);
    while (!p.ended()) // a stroke ends before its stream
        std::this_thread::yield();
    try {
        p.submit(tone(0.1));
        FAIL("no error");
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::runtime);
        CHECK(std::string(e.what()).find("the device is gone") != std::string::npos);
    }
    p.stop();
}

TEST_CASE("an xrun is counted and survived")
{
    dac_player p;
    const stroke_id id = p.submit(tone(endless_s));
    run_until(p.dac, 288, [&] { return p.position().stroke == id; });
    p.dac.advance(10'000);
    const auto r = p.wait(id);
    REQUIRE(r);
    CHECK(r->state == state_kind::interrupted);
    CHECK(r->why == "xrun: the device ran dry");
    CHECK(r->reason == reason_kind::xrun);
    p.dac.await([&] { return p.dac.starts() == 2; });
    CHECK(p.stats().xruns == 1);
    const running_clock clock(p.dac);
    CHECK(p.wait(p.submit(tone(0.01)))->state == state_kind::finished);
    p.stop(); // while the clock still runs
}

TEST_CASE("a wait tells a time-out, a report taken before, and an unknown stroke apart")
{
    dac_player p;
    CHECK(p.wait({17}).outcome() == wait_kind::unknown);
    CHECK(p.wait({}).outcome() == wait_kind::unknown);
    const stroke_id id = p.submit(tone(endless_s));
    const wait_result none = p.wait(id, 1e-9);
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

TEST_CASE("a device that does not start and a missing sink are errors")
{
    fake_dac broken;
    broken.fail_start(-EIO);
    CHECK_THROWS_AS(player(alsa::adopt(broken.pcm(), nine()), palm()), error);
    CHECK(broken.closed());
    CHECK_THROWS_AS(player(nullptr, palm()), error);
}

TEST_CASE("a required real-time priority that is refused is an error; otherwise a note")
{
    fake_dac dac;
    player_options o = patient();
    o.require_realtime = true;
    const running_clock clock(dac);
    bool realtime = true;
    try {
        const player p(alsa::adopt(dac.pcm(), nine()), palm(), o);
        CHECK(p.stats().realtime);
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::not_available);
        realtime = false;
    }
    fake_dac other;
    const running_clock other_clock(other);
    const player p(alsa::adopt(other.pcm(), nine()), palm(), patient());
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

namespace {

// Changes its set-up with each start, like a PCM that turns out to have no clock.
class changing_sink final : public forwarding_sink {
public:
    explicit changing_sink(std::unique_ptr<sink> s)
        : forwarding_sink(std::move(s)), setup_(forwarding_sink::setup())
    {
    }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind start() noexcept override
    {
        setup_.has_clock = !setup_.has_clock;
        return forwarding_sink::start();
    }

private:
    stream_setup setup_;
};

} // namespace

TEST_CASE("a player's set-up is that of the start, whatever the audio thread finds out later")
{
    fake_dac dac;
    auto changing = std::make_unique<changing_sink>(alsa::adopt(dac.pcm(), nine()));
    const stream_setup& own = changing->setup();
    player p(std::move(changing), palm(), patient());
    CHECK_FALSE(p.setup().has_clock);
    CHECK(&p.setup() != &own);
}

} // namespace player_test
