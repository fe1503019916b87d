// SPDX-License-Identifier: MIT
// Devices without a clock, which get one.
#include <random>
#include <span>

#include <poll.h>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>

#include "sink/pacer.hpp"

namespace pacer_test {

using namespace tactor;
using detail::virtual_queue;

TEST_CASE("a virtual queue plays at its rate, without drift over a week")
{
    for (const unsigned rate : {8000U, 44100U, 48000U, 192000U, 11025U}) {
        CAPTURE(rate);
        virtual_queue q(rate, 300);
        const std::int64_t origin = 123'456'789;
        q.start(origin, 0);
        const std::uint64_t week = std::uint64_t{7} * 24 * 3600 * rate;
        q.wrote(week + 300);
        CHECK(q.played(origin) == 0);
        CHECK(q.played(origin + 1'000'000'000) == rate);
        CHECK(q.played(origin + std::int64_t{7} * 24 * 3600 * 1'000'000'000) == week);
        CHECK(q.played(origin + std::int64_t{7} * 24 * 3600 * 1'000'000'000 - 1) == week - 1);
    }
}

TEST_CASE("at the deadline the period fits, and not before")
{
    std::mt19937_64 random(1);
    for (int round = 0; round < 200; ++round) {
        const auto rate = static_cast<unsigned>(8000 + random() % 184'001);
        const auto period = 1 + random() % 500;
        const auto buffer = period * (2 + random() % 4);
        virtual_queue q(rate, static_cast<unsigned>(buffer));
        std::int64_t now = static_cast<std::int64_t>(random() % 1'000'000'000'000);
        q.start(now, buffer);
        for (int i = 0; i < 100; ++i) {
            const std::int64_t t = q.time_of_room(period);
            REQUIRE(t > now);
            REQUIRE(q.available(t - 1) < period);
            REQUIRE(q.available(t) >= period);
            now = t;
            q.wrote(period);
        }
    }
}

TEST_CASE("a writer that comes too late stops the virtual clock, and nothing is lost")
{
    virtual_queue q(48000, 288);
    q.start(0, 288);
    const std::int64_t late = 10'000'000'000;
    CHECK(q.played(late) == 288);
    CHECK(q.available(late) == 288);
    q.wrote(96);
    CHECK(q.played(late) == 288);
    CHECK(q.played(late + 1'000'000) == 336);
    CHECK(q.time_of_room(288) == late + 2'000'000);
}

TEST_CASE("time that runs backwards plays nothing back")
{
    virtual_queue q(48000, 288);
    q.start(1'000'000'000, 288);
    CHECK(q.played(0) == 0);
    CHECK(q.available(0) == 0);
}

TEST_CASE("the timer becomes readable when a period fits")
{
    detail::pacer p(48000, 288, 96);
    const std::int64_t begun = rt::monotonic_ns();
    p.start(288);
    p.arm();
    pollfd fd{.fd = p.fd(), .events = POLLIN, .revents = 0};
    while (!p.due()) {
        REQUIRE(::poll(&fd, 1, 10'000) == 1);
        p.arm();
    }
    CHECK(p.available() >= 96);
    CHECK(rt::monotonic_ns() - begun >= 2'000'000); // 96 frames
    p.arm();
    CHECK(::poll(&fd, 1, 10'000) == 1); // the space is still there
}

namespace {

// Writes `frames` frames through the device's pacer; returns the most periods at a time.
std::uint64_t write_all(sink& s, std::uint64_t frames)
{
    REQUIRE(s.prepare() == io_kind::ok);
    const stream_setup& d = s.setup();
    const std::vector<std::byte> silence(d.buffer_frames * d.frame_bytes());
    REQUIRE(s.write(silence).frames == d.buffer_frames);
    REQUIRE(s.start() == io_kind::ok);
    CHECK_FALSE(d.has_clock);
    std::uint64_t wakes = 0;
    while (s.position().written < frames) {
        pollfd fd{};
        REQUIRE(s.max_descriptors() >= 1);
        REQUIRE(s.descriptors(std::span(&fd, 1)) == 1);
        REQUIRE(::poll(&fd, 1, 10'000) == 1);
        if (s.ready(std::span(&fd, 1)) != io_kind::ok)
            continue;
        ++wakes;
        const io_result r = s.write(std::span(silence).first(d.period_frames * d.frame_bytes()));
        REQUIRE(r.status == io_kind::ok);
        REQUIRE(r.frames == d.period_frames);
    }
    return wakes;
}

} // namespace

TEST_CASE("null, file, plug and multi of nulls are found to have no clock, and are paced")
{
    const std::string nulls =
        "pcm.n { type null }\n"
        "pcm.file { type file slave.pcm n file \"/dev/null\" format raw }\n"
        "pcm.plug { type plug slave.pcm n }\n"
        "pcm.linear { type linear slave { pcm n format S16_LE } }\n"
        "pcm.multi { type multi slaves.a { pcm n channels 1 } slaves.b { pcm n channels 1 }\n"
        "  bindings.0 { slave a channel 0 } bindings.1 { slave b channel 0 } }\n"
        "pcm.pluggedmulti { type plug slave.pcm multi }\n"
        "pcm.null { type null }\n";
    for (const char* name : {"null", "file", "plug", "linear", "multi", "pluggedmulti"}) {
        CAPTURE(name);
        alsa_options o;
        o.pcm = name;
        o.channels = 2;
        o.config_text = nulls;
        const auto s = open_alsa(o);
        const std::int64_t begun = rt::monotonic_ns();
        const std::uint64_t wakes = write_all(*s, 288 + 20 * 96);
        CHECK(wakes == 20);
        // 20 periods take 40 ms, and the first is not awaited in full.
        CHECK(rt::monotonic_ns() - begun > 36'000'000);
        s->drop();
    }
}

TEST_CASE("plug:null of the system's configuration is paced as well")
{
    alsa_options o;
    o.pcm = "plug:null";
    o.channels = 9;
    const auto s = open_alsa(o);
    write_all(*s, 288 + 96 * 3);
}

} // namespace pacer_test
