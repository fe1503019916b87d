// SPDX-License-Identifier: MIT
// Records of a stream: the program's log and its counters.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <poll.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "amplifier_rig.hpp"
#include "clock_runner.hpp"
#include "engine/control/records.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "rt/event_fd.hpp"
#include "scores.hpp"

namespace records_test {

using namespace tactor;
using namespace tactor::test;

namespace {

struct heard {
    std::mutex mutex; // a player's lines come from its control thread
    std::vector<std::string> lines;

    log_function function()
    {
        return [this](log_kind k, std::string_view text) {
            const std::lock_guard lock(mutex);
            lines.push_back(std::string(to_string(k)) + " " + std::string(text));
        };
    }
    std::size_t count(std::string_view part)
    {
        const std::lock_guard lock(mutex);
        return static_cast<std::size_t>(std::count_if(
            lines.begin(), lines.end(), [&](const std::string& l) { return l.find(part) != l.npos; }));
    }
};

// A rig whose control side looks after each period.
template <typename Rig>
struct logged : Rig {
    explicit logged(const rig_options& o = {}, const drive_limits& held = {})
        : Rig(o), log(told.function(), this->link, held)
    {
        this->also_control = [this, before = this->also_control] {
            if (before)
                before();
            log.look(this->status(), this->now);
            log.write();
        };
    }
    heard told;
    engine::stream_log log;
};

// Reports n ms for its n-th xrun.
class dry_sink final : public forwarding_sink {
public:
    using forwarding_sink::forwarding_sink;
    std::int64_t xrun_ns() noexcept override { return ++xruns_ * 1'000'000; }

private:
    std::int64_t xruns_ = 0;
};

// Plays all frames at once.
class hasty_sink final : public sink {
public:
    hasty_sink() { ready_.signal(); }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override { return io_kind::ok; }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }
    std::size_t max_descriptors() const noexcept override { return 1; }
    std::size_t descriptors(std::span<pollfd> fds) noexcept override
    {
        fds[0] = {.fd = ready_.fd(), .events = POLLIN, .revents = 0};
        return 1;
    }
    io_kind ready(std::span<pollfd>) noexcept override { return io_kind::ok; }
    io_result available() noexcept override { return {io_kind::ok, setup_.buffer_frames, 0}; }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const std::size_t n = frames.size() / setup_.frame_bytes();
        written_ += n;
        return {io_kind::ok, n, 0};
    }
    stream_position position() noexcept override
    {
        time_ns_ += 1'000'000;
        return {written_, written_, time_ns_, true};
    }
    void drop() noexcept override {}

private:
    stream_setup setup_{
        .name = "hasty", .channels = 9, .rate = rate, .period_frames = 96, .buffer_frames = 288};
    rt::event_fd ready_;
    std::uint64_t written_ = 0;
    std::int64_t time_ns_ = 0;
};

} // namespace

TEST_CASE("an xrun is a line, and so is the restart of the stream")
{
    logged<rig> r;
    r.play(9600);
    CHECK(r.told.count("") == 1); // strokes may sound
    r.xrun();
    CHECK(r.told.count("warning xrun 1: the device ran dry") == 1);
    CHECK(r.told.count("info the stream runs again, started 2 times so far") == 1);
    r.play(9600);
    CHECK(r.told.count("xrun") == 1);
}

TEST_CASE("the reason why a lost device ended the stream is a line, once")
{
    logged<rig> r;
    r.play(960);
    r.dac.disconnect();
    for (int i = 0; i < 10 && !r.loop.over(); ++i)
        r.step();
    r.control();
    REQUIRE(r.feed.stream_over());
    r.log.end(r.feed.end().why);
    r.log.end(r.feed.end().why);
    r.log.write();
    CHECK(r.told.count("error the stream has ended: the device is gone") == 1);
}

TEST_CASE("a muted amplifier is a line")
{
    logged<playing> r;
    CHECK(r.told.count("mute") == 0);
    r.line.is_on = false; // like after its holder's death: beat() shows it
    r.wait(200 * ms);
    r.play(960);
    CHECK(r.told.count("warning the amplifier was muted") == 1);
}

TEST_CASE("limits that act are logged once a second at most")
{
    rig_options o;
    o.loop.guards = synth::make_guards({.power_dbfs = -60.0}, rate);
    logged<rig> r(o, {.power_dbfs = -60.0});
    r.submit(tone(2.5));
    r.play(120'000);
    CHECK(r.told.count("warning the limit reduced the power of all tactors to -60 dBFS") == 3);
}

TEST_CASE("a player logs its start and its end, and survives a log that throws")
{
    for (const bool throws : {false, true}) {
        CAPTURE(throws);
        heard told;
        player_options o = patient();
        o.log = [to = told.function(), throws](log_kind k, std::string_view text) {
            to(k, text);
            if (throws)
                throw std::runtime_error("log");
        };
        {
            dac_player p(o);
            CHECK(told.count("info stream on \"null\" runs: 9 channels at 48000 Hz, 3 of 96 frames") == 1);
            const stroke_id id = p.submit(tone(0.1));
            const running_clock clock(p.dac);
            REQUIRE(p.wait(id));
            p.stop();
            CHECK(p.ended()->reason == reason_kind::none);
        }
        CHECK(told.count("info the stream has ended") == 1);
    }
}

TEST_CASE("a live stroke above its level is logged once, at its end")
{
    heard told;
    player_options o = patient();
    o.log = told.function();
    dac_player p(o);
    const running_clock clock(p.dac);
    for (const double intensity : {80.0, 1.0}) {
        live_stroke live = p.begin({.timeout_s = 86400.0});
        live.to(20.0, 20.0, intensity);
        live.to(20.0, 20.0, intensity);
        CHECK(live.counts().held == (intensity > 1.0 ? 2 : 0));
        live.end();
        CHECK(p.wait(live.id())->held_points == live.counts().held);
    }
    p.stop();
    CHECK(told.count("warning live stroke 1: 2 points above intensity 1 played as 1") == 1);
    CHECK(told.count("live stroke") == 1);
}

TEST_CASE("the length of each xrun is kept, of many the newest")
{
    rig_options o;
    o.wrap = [](std::unique_ptr<sink> s) { return std::make_unique<dry_sink>(std::move(s)); };
    rig r(o);
    for (unsigned i = 1; i <= 70; ++i) {
        r.play(rate); // more than three in a second end the stream
        r.dac.advance(1 << 20);
        r.step();
        r.control();
        REQUIRE(r.link.count.xruns == i);
        CHECK(r.link.count.xrun_ns[(i - 1) % r.link.count.xrun_ns.size()] == i * 1'000'000);
    }
    CHECK_FALSE(r.loop.over());
}

TEST_CASE("an audio thread that never rests gives up real time, reports it once, and plays on")
{
    std::atomic<bool> fifo{false};
    std::atomic<int> told{0};
    std::string text;
    player_options o = patient();
    o.realtime = true;
    o.log = [&](log_kind kind, std::string_view line) {
        fifo = fifo || line == "the audio thread has real-time priority";
        if (line.find("gave up") == std::string_view::npos)
            return;
        CHECK(kind == log_kind::warning);
        text = line;
        ++told;
        told.notify_all();
    };
    player p(std::make_unique<hasty_sink>(), palm(), o);
    if (fifo)
        told.wait(0);
    else
        MESSAGE("no real-time priority here: checks only that nothing is given up");
    CHECK_FALSE(p.stats().realtime);
    CHECK(p.wait(p.submit(tone(0.01)))->state == state_kind::finished);
    p.stop();
    CHECK(told == (fifo ? 1 : 0));
    if (fifo)
        has(text,
            "the audio thread gave up its real-time priority: it had worked for some 0.1 s without a pause");
}

} // namespace records_test
