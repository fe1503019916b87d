// SPDX-License-Identifier: MIT
// Devices that sleep, and one that gives no descriptors.
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <poll.h>

#include <doctest/doctest.h>

#include "fake_dac.hpp"
#include "live_rig.hpp"
#include "player_support.hpp"
#include "sink/alsa/adopt.hpp"

namespace suspend_test {

using namespace tactor;
using namespace tactor::test;

namespace {

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
        for (int i = 0; i < 50; ++i) {
            r.step();
            r.control();
        }
        CHECK_FALSE(r.status().running);
        CHECK_FALSE(r.loop.polls_sink());
        CHECK(r.loop.timeout_ns() == 2'000'000);
        CHECK_FALSE(r.loop.over());
        CHECK(r.end(id).state == state_kind::interrupted);
        CHECK(r.end(id).why == "the system was suspended");
        CHECK(r.end(id).reason == reason_kind::suspended);
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
        r.play_out();
        CHECK(r.end(waiting).state == state_kind::finished);
        // The old stroke does not sound again.
        CHECK(r.first_sound(captured) == captured + 289);
        CHECK(r.link.count.xruns == 0);
    }
}

TEST_CASE("a device that never wakes up neither ends nor spins")
{
    rig r;
    r.dac.suspend();
    const std::int64_t begun = r.now;
    for (int i = 0; i < 10'000; ++i)
        r.step();
    const std::int64_t took = r.now - begun;
    CHECK(r.loop.over() == false);
    // prepare() returns "suspended" again and again: no end, no spinning, no xrun.
    CHECK(took >= 10'000 * 1'900'000LL);
    CHECK(r.link.count.xruns == 0);
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
        live_options l;
        l.longest_s = 2.0;
        live_rig r(l, o);
        r.play(960);
        r.dac.suspend();
        r.step();
        r.live->to({20.0, 20.0}, 1.0);
        const std::uint64_t written = r.status().written;
        r.dac.wake(true);
        for (int i = 0; i < 40; ++i)
            r.play(96);
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

} // namespace suspend_test
