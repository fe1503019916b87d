// SPDX-License-Identifier: MIT
// Devices that run dry, sleep, vanish, or stand still.
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <poll.h>

#include "fake_dac.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace faults_test {

using namespace tactor;
using namespace tactor::test;

namespace {

enum class seen { nothing, the_start, where_it_was };

// Returns options for a device that takes frames, but gives no position: never, or not once it is blind.
rig_options without_position(seen what, const bool& blind)
{
    rig_options o;
    o.wrap = [what, &blind](std::unique_ptr<sink> s) {
        const auto hide = [what, &blind, last = std::uint64_t{0}](stream_position& p) mutable {
            if (!blind)
                last = p.played;
            p.valid = what != seen::nothing;
            p.played = what == seen::where_it_was ? last : 0;
        };
        return std::make_unique<position_sink>(std::move(s), hide);
    };
    return o;
}

// Plays until the stream is over; returns how long that took, ns.
std::int64_t play_until_over(rig& r)
{
    const std::int64_t begun = r.now;
    for (int i = 0; i < 10'000 && !r.loop.over(); ++i)
        r.play(r.options.period);
    return r.now - begun;
}

// Returns "again" for each resume.
class sleepy_sink final : public forwarding_sink {
public:
    using forwarding_sink::forwarding_sink;
    io_kind resume() noexcept override { return io_kind::again; }
};

/// Fails the second start, after its buffer was filled.
class slow_starter final : public forwarding_sink {
public:
    slow_starter(std::unique_ptr<sink> s, io_kind says) : forwarding_sink(std::move(s)), says_(says) {}
    io_kind start() noexcept override { return ++starts_ == 2 ? says_ : forwarding_sink::start(); }

private:
    io_kind says_;
    int starts_ = 0;
};

} // namespace

TEST_CASE("an xrun interrupts what sounds, and the stream goes on in silence")
{
    rig r;
    const std::uint64_t base = r.status().written;
    const stroke_id id = r.submit(tone(1.0));
    r.play(9600);
    const std::uint64_t written = r.dac.captured_frames();
    r.xrun();
    CHECK(ending(r.end(id)) == "interrupted, xrun: xrun: the device ran dry");
    CHECK(r.end(id).frames == written - base);
    CHECK(r.link.count.xruns == 1);
    CHECK(r.dac.starts() == 2);
    CHECK(r.status().running);
    r.play(48'000);
    CHECK_FALSE(r.first_sound(written));

    const std::uint64_t again = r.dac.captured_frames();
    const score s = random_score(2, 3);
    CHECK(r.play_out(r.submit(s)).state == state_kind::finished);
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
        CHECK(r.play_out(id).state == state_kind::finished);
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
    CHECK(ending(r.end(far)) == "interrupted, lost: the device was closed after too many xruns in a row");
}

TEST_CASE("an unplugged device ends the stream and every stroke")
{
    rig r;
    const stroke_id sounding = r.submit(tone(1.0));
    const stroke_id near = r.submit(tone(1.0), r.status().written + 15'000);
    const stroke_id far = r.submit(tone(1.0), 10 * rate);
    r.play(4800);
    r.dac.disconnect();
    r.run_until_over(10);
    r.control();
    CHECK(r.loop.over());
    for (const stroke_id id : {sounding, near, far}) {
        CHECK(ending(r.end(id)) == "interrupted, lost: the device is gone");
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
        const std::int64_t took = r.run_until_over(10'000);
        CHECK(r.loop.over());
        CHECK(took >= 500'000'000);
        CHECK(took <= 520'000'000);
        r.control();
        CHECK(ending(r.end(id)) == "interrupted, lost: the device stopped");
        CHECK(r.link.count.xruns == 0);
    }
}

TEST_CASE("a device that takes frames but gives no position is lost after its time")
{
    for (const seen what : {seen::nothing, seen::the_start, seen::where_it_was}) {
        CAPTURE(static_cast<int>(what));
        bool blind = false;
        rig r(without_position(what, blind));
        const stroke_id id = r.submit(tone(5.0));
        r.play(9600);
        REQUIRE(r.status().running);
        const std::int64_t stands = what == seen::where_it_was ? 0 : 200'000'000;
        blind = true;
        const std::int64_t took = play_until_over(r) + stands;
        CHECK(r.loop.over());
        CHECK(took >= 500'000'000);
        CHECK(took <= 510'000'000);
        CHECK(ending(r.end(id)) == "interrupted, lost: the device stopped");
        CHECK(r.link.count.xruns == 0);
    }
}

TEST_CASE("the duration of a start does not count against the device")
{
    rig r;
    r.now += 600'000'000; // a server woke its card
    r.run_until_over(20);
    CHECK_FALSE(r.loop.over());
}

TEST_CASE("stop does not wait for a position that never comes")
{
    const bool blind = true;
    rig r(without_position(seen::nothing, blind));
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
        r.run_until_over(10);
        r.control();
        CHECK(r.loop.over());
        CHECK(ending(r.end(id)) == "interrupted, xrun: xrun: the device ran dry");
        CHECK(r.feed.end().why.find("device failed") != std::string::npos);
    }
}

TEST_CASE("a suspended device is resumed when it can, with a fresh stream")
{
    for (const bool can_resume : {true, false}) {
        CAPTURE(can_resume);
        rig r;
        const std::uint64_t base = r.status().written;
        const stroke_id id = r.submit(tone(1.0));
        r.play(9600);
        const std::uint64_t played = r.status().played;
        r.dac.suspend();
        r.run_until_over(50);
        CHECK_FALSE(r.status().running);
        CHECK_FALSE(r.loop.polls_sink());
        CHECK(r.loop.timeout_ns() == 2'000'000);
        CHECK_FALSE(r.loop.over());
        CHECK(ending(r.end(id)) == "interrupted, suspended: the system was suspended");
        CHECK(r.end(id).frames <= played - base);

        const stroke_id waiting = r.submit(tone(0.01));
        r.step();
        CHECK(r.ended.size() == 1);
        r.dac.wake(can_resume);
        const std::uint64_t captured = r.dac.captured_frames();
        r.step();
        CHECK(r.status().running);
        CHECK(r.dac.captured_frames() == captured + 288);
        CHECK(r.dac.starts() == 2);
        CHECK(r.play_out(waiting).state == state_kind::finished);
        // The old stroke does not sound again.
        CHECK(r.first_sound(captured) == captured + 289);
        CHECK(r.link.count.xruns == 0);
    }
}

TEST_CASE("a resume that is never ready is given up after ten seconds, for a fresh start")
{
    rig r({.wrap = [](auto s) { return std::make_unique<sleepy_sink>(std::move(s)); }});
    r.play(960);
    r.dac.suspend();
    r.step();
    CHECK_FALSE(r.status().running);
    r.dac.wake(false);
    const std::int64_t begun = r.now;
    while (!r.status().running && !r.loop.over())
        r.step();
    CHECK(r.status().running);
    CHECK(r.now - begun >= 9'900'000'000);
    CHECK(r.now - begun <= 10'100'000'000);
    r.play(9600);
    CHECK(r.status().running);
}

TEST_CASE("stop ends a suspended stream at once")
{
    rig r;
    r.dac.suspend();
    r.play(960);
    r.stop();
    r.step();
    r.control();
    CHECK(r.loop.over());
    CHECK(r.feed.stream_over());
    CHECK(r.feed.end().why.empty());
}

TEST_CASE("a stroke that begins in a buffer that is filled and not started ends there, once")
{
    for (const io_kind says : {io_kind::xrun, io_kind::suspended}) {
        CAPTURE(static_cast<int>(says));
        rig_options o;
        o.wrap = [&](std::unique_ptr<sink> s) { return std::make_unique<slow_starter>(std::move(s), says); };
        live_rig r({.longest_s = 2.0}, o);
        r.play(960);
        r.dac.suspend();
        r.step();
        r.live->to({20.0, 20.0}, 1.0);
        const std::uint64_t written = r.status().written;
        r.dac.wake(true);
        r.play(3840);
        CHECK(r.status().running);
        CHECK(r.status().written > written);
        CHECK(r.end({1}).state == state_kind::interrupted);
        CHECK(r.end({1}).reason == (says == io_kind::xrun ? reason_kind::xrun : reason_kind::suspended));
        CHECK(r.end({1}).frames == 0);
        CHECK(r.ended.size() == 1);
        CHECK(r.link.count.suspends == (says == io_kind::xrun ? 1 : 2));
    }
}

TEST_CASE("a device without descriptors in an xrun, such as dmix, is not asked about them")
{
    fake_dac dac;
    dac.hide_descriptors_in_xrun();
    const auto s = alsa::adopt(dac.pcm(), nine());
    std::vector<std::byte> silence(288 * s->setup().frame_bytes());
    REQUIRE(s->prepare() == io_kind::ok);
    REQUIRE(s->write(silence).frames == 288);
    REQUIRE(s->start() == io_kind::ok);
    std::vector<pollfd> fds(s->max_descriptors());
    CHECK(s->descriptors(fds) == 1);
    CHECK(s->ready(std::span(fds).first(1)) == io_kind::again);
    dac.advance(10'000);
    CHECK(s->available().status == io_kind::xrun);
    const std::size_t n = s->descriptors(fds);
    CHECK(n == 0);
    CHECK(s->ready(std::span(fds).first(n)) == io_kind::xrun);
    CHECK(dac.asked_in_vain() == 0);
}

} // namespace faults_test
