// SPDX-License-Identifier: MIT
// Devices that run dry, vanish, or stand still.
#include <memory>
#include <utility>

#include <doctest/doctest.h>

#include "rig.hpp"

namespace faults_test {

using namespace tactor;
using namespace tactor::test;

namespace {

enum class seen { nothing, the_start, where_it_was };

// Takes frames, but gives no position: never, or not once it is blind.
class blind_sink final : public forwarding_sink {
public:
    blind_sink(std::unique_ptr<sink> s, seen what, const bool& blind)
        : forwarding_sink(std::move(s)), what_(what), blind_(blind)
    {
    }
    stream_position position() noexcept override
    {
        stream_position p = forwarding_sink::position();
        if (!blind_)
            last_ = p.played;
        p.valid = what_ != seen::nothing;
        p.played = what_ == seen::where_it_was ? last_ : 0;
        return p;
    }

private:
    seen what_;
    const bool& blind_;
    std::uint64_t last_ = 0;
};

// Plays until the stream is over; returns how long that took, ns.
std::int64_t play_until_over(rig& r)
{
    const std::int64_t begun = r.now;
    for (int i = 0; i < 10'000 && !r.loop.over(); ++i)
        r.play(r.options.period);
    return r.now - begun;
}

// Steps until the stream is over; returns how long that took, ns.
std::int64_t run_until_over(rig& r, int steps)
{
    const std::int64_t begun = r.now;
    for (int i = 0; i < steps && !r.loop.over(); ++i) {
        r.step();
        r.control();
    }
    return r.now - begun;
}

} // namespace

TEST_CASE("the stream starts once, after a full buffer of silence")
{
    rig r;
    CHECK(r.dac.starts() == 1);
    CHECK(r.dac.captured_frames() == 288);
    CHECK(r.dac.queued() == 288);
    CHECK(r.out->setup().has_clock);
    CHECK_FALSE(r.first_sound());
}

TEST_CASE("an xrun interrupts what sounds, and the stream goes on in silence")
{
    rig r;
    const std::uint64_t base = r.status().written;
    const stroke_id id = r.submit(tone(1.0));
    r.play(9600);
    const std::uint64_t written = r.dac.captured_frames();
    r.xrun();
    CHECK(r.end(id).state == state_kind::interrupted);
    CHECK(r.end(id).why == "xrun: the device ran dry");
    CHECK(r.end(id).reason == reason_kind::xrun);
    CHECK(r.end(id).frames == written - base);
    CHECK(r.link.count.xruns == 1);
    CHECK(r.dac.starts() == 2);
    CHECK(r.status().running);
    r.play(48'000);
    CHECK_FALSE(r.first_sound(written));

    const std::uint64_t again = r.dac.captured_frames();
    const score s = random_score(2, 3);
    const stroke_id next = r.submit(s);
    r.play_out();
    CHECK(r.end(next).state == state_kind::finished);
    CHECK(r.captured(again, s.frames()) == rendered(s, format_kind::s32));
}

TEST_CASE("a stroke that had not begun survives an xrun and keeps its distance")
{
    for (const std::uint64_t ahead : {std::uint64_t{5'000}, std::uint64_t{15'000}, std::uint64_t{200'000}}) {
        CAPTURE(ahead);
        rig r;
        const score s = random_score(5, 4);
        const std::uint64_t at = r.status().written + ahead;
        const stroke_id id = r.submit(s, at);
        r.play(1920);
        REQUIRE(r.status().written < at);
        r.xrun();
        r.play_out();
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.captured(at, s.frames()) == rendered(s, format_kind::s32));
        CHECK(r.first_sound() > at - 1);
    }
}

TEST_CASE("a cancelled stroke that an xrun cuts is still cancelled, a finished one finished")
{
    rig r;
    const stroke_id cancelled = r.submit(tone(1.0));
    r.play(9600);
    const stroke_id done = r.submit(tone(0.001));
    CHECK(r.feed.cancel(cancelled));
    r.dac.advance_queued(96);
    r.step();
    r.xrun();
    CHECK(r.end(cancelled).state == state_kind::cancelled);
    CHECK(r.end(done).state == state_kind::finished);
}

TEST_CASE("three xruns a second are survived, the fourth ends the stream")
{
    rig r;
    const stroke_id far = r.submit(tone(0.1), 10 * rate);
    for (int i = 0; i < 3; ++i) {
        r.play(4800);
        r.dac.advance(1000);
        r.step();
        CHECK(r.status().running);
    }
    r.play(4800);
    r.xrun();
    CHECK(r.loop.over());
    CHECK(r.link.count.xruns == 4);
    CHECK(r.feed.stream_over());
    CHECK(r.end(far).state == state_kind::interrupted);
    CHECK(r.end(far).why == "the device was given up: one xrun after the other");
    CHECK(r.end(far).reason == reason_kind::lost);
}

TEST_CASE("xruns that are further apart never end the stream")
{
    rig r;
    for (int i = 0; i < 20; ++i) {
        r.play(17'000);
        r.dac.advance(1000);
        r.step();
        REQUIRE(r.status().running);
    }
    CHECK(r.link.count.xruns == 20);
}

TEST_CASE("an unplugged device ends the stream and every stroke")
{
    rig r;
    const stroke_id sounding = r.submit(tone(1.0));
    const stroke_id near = r.submit(tone(1.0), r.status().written + 15'000);
    const stroke_id far = r.submit(tone(1.0), 10 * rate);
    r.play(4800);
    r.dac.disconnect();
    run_until_over(r, 10);
    r.control();
    CHECK(r.loop.over());
    for (const stroke_id id : {sounding, near, far}) {
        CHECK(r.end(id).state == state_kind::interrupted);
        CHECK(r.end(id).why == "the device is gone");
        CHECK(r.end(id).reason == reason_kind::lost);
        CHECK((r.end(id).frames > 0) == (id == sounding));
    }
    CHECK(r.feed.end().why == "the device is gone");
    CHECK(r.feed.end().reason == reason_kind::lost);
}

TEST_CASE("a device that stands still is lost after its time, ready or not")
{
    for (const bool cries : {false, true}) {
        CAPTURE(cries);
        rig r;
        const stroke_id id = r.submit(tone(1.0));
        r.play(4800);
        r.dac.cry_ready(cries);
        const std::int64_t took = run_until_over(r, 10'000);
        CHECK(r.loop.over());
        CHECK(took >= 500'000'000);
        CHECK(took <= 520'000'000);
        r.control();
        CHECK(r.end(id).state == state_kind::interrupted);
        CHECK(r.end(id).why == "the device does not move any more");
        CHECK(r.end(id).reason == reason_kind::lost);
        CHECK(r.link.count.xruns == 0);
    }
}

TEST_CASE("a device that takes frames but gives no position is lost after its time")
{
    for (const seen what : {seen::nothing, seen::the_start, seen::where_it_was}) {
        CAPTURE(static_cast<int>(what));
        bool blind = false;
        rig_options o;
        o.wrap = [&](auto s) { return std::make_unique<blind_sink>(std::move(s), what, blind); };
        rig r(o);
        const stroke_id id = r.submit(tone(5.0));
        r.play(9600);
        REQUIRE(r.status().running);
        const std::int64_t stands = what == seen::where_it_was ? 0 : 200'000'000;
        blind = true;
        const std::int64_t took = play_until_over(r) + stands;
        CHECK(r.loop.over());
        CHECK(took >= 500'000'000);
        CHECK(took <= 510'000'000);
        CHECK(r.end(id).state == state_kind::interrupted);
        CHECK(r.end(id).why == "the device does not move any more");
        CHECK(r.end(id).reason == reason_kind::lost);
        CHECK(r.link.count.xruns == 0);
    }
}

TEST_CASE("the duration of a start does not count against the device")
{
    rig r;
    r.now += 600'000'000; // a server woke its card
    run_until_over(r, 20);
    CHECK_FALSE(r.loop.over());
}

TEST_CASE("stop does not wait for a position that never comes")
{
    bool blind = true;
    rig_options o;
    o.wrap = [&](auto s) { return std::make_unique<blind_sink>(std::move(s), seen::nothing, blind); };
    rig r(o);
    const stroke_id id = r.submit(tone(5.0));
    r.play(960);
    r.stop();
    CHECK(play_until_over(r) <= 410'000'000);
    CHECK(r.end(id).state == state_kind::cancelled);
    CHECK(r.feed.end().why.empty());
}

TEST_CASE("a device that lies about being ready is polled less often, so that nothing spins")
{
    rig r;
    r.dac.cry_ready(true);
    for (int i = 0; i < 30; ++i)
        r.step();
    CHECK_FALSE(r.loop.polls_sink());
    CHECK(r.loop.timeout_ns() == 2'000'000);
    r.dac.cry_ready(false);
    r.play(960);
    CHECK(r.loop.polls_sink());
}

TEST_CASE("a process that was stopped for a minute does not give up its device")
{
    rig r;
    r.play(4800);
    r.now += 60'000'000'000;
    for (int i = 0; i < 3; ++i) // the device gets on when the process does
        r.step();
    CHECK(r.status().running);
    r.play(4800);
    CHECK(r.status().running);
}

TEST_CASE("a device that does not prepare or start again ends the stream")
{
    for (const bool prepares : {false, true}) {
        rig r;
        const stroke_id id = r.submit(tone(1.0));
        r.play(960);
        if (prepares)
            r.dac.fail_start(-EIO);
        else
            r.dac.fail_prepare(-EIO);
        r.dac.advance(1000);
        run_until_over(r, 10);
        r.control();
        CHECK(r.loop.over());
        CHECK(r.end(id).state == state_kind::interrupted);
        CHECK(r.end(id).why == "xrun: the device ran dry");
        CHECK(r.end(id).reason == reason_kind::xrun);
        CHECK(r.feed.end().why.find("device failed") != std::string::npos);
    }
}

TEST_CASE("a device that does not start at first fails the start")
{
    rig r({.started = false});
    r.dac.fail_start(-EIO);
    CHECK(r.start().status == io_kind::failed);
    CHECK_FALSE(r.status().running);
}

} // namespace faults_test
