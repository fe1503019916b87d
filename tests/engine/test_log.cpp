// SPDX-License-Identifier: MIT
// The program's log of the stream.
#include <algorithm>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "amplifier_rig.hpp"
#include "clock_runner.hpp"
#include "engine/control/stream_log.hpp"
#include "player_support.hpp"

namespace log_test {

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

} // namespace

TEST_CASE("an xrun is a line, and so is the restart of the stream")
{
    logged<rig> r;
    r.play(9600);
    CHECK(r.told.count("") == 1); // strokes may sound
    r.xrun();
    CHECK(r.told.count("warning xrun 1: the device ran dry") == 1);
    CHECK(r.told.count("info the stream runs again, started 2 times by now") == 1);
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
    CHECK(r.told.count("warning the power of all tactors was held at -60 dBFS") == 3);
}

TEST_CASE("without a log nothing is gathered")
{
    engine::link l;
    engine::stream_log silent({}, l, {});
    l.count.count_xrun(5);
    silent.look({}, 1);
    silent.end("");
    silent.write();
    CHECK_FALSE(silent.on());
}

TEST_CASE("a player logs its start and its end, and survives a log that throws")
{
    for (const bool throws : {false, true}) {
        CAPTURE(throws);
        fake_dac dac;
        heard told;
        player_options o = patient();
        o.log = [to = told.function(), throws](log_kind k, std::string_view text) {
            to(k, text);
            if (throws)
                throw std::runtime_error("log");
        };
        {
            player p(alsa::adopt(dac.pcm(), nine()), palm(), o);
            CHECK(told.count("info stream on \"null\" runs: 9 channels at 48000 Hz, 3 of 96 frames") == 1);
            const stroke_id id = p.submit(tone(0.1));
            const running_clock clock(dac);
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
    CHECK(told.count("warning live stroke 1: 2 points above intensity 1 sounded as 1") == 1);
    CHECK(told.count("live stroke") == 1);
}

TEST_CASE("kinds have names, and names kinds")
{
    for (const log_kind k : {log_kind::debug, log_kind::info, log_kind::warning, log_kind::error})
        CHECK(from_string<log_kind>(to_string(k)) == k);
    CHECK_THROWS_WITH_AS(from_string<log_kind>("warn"),
                         doctest::Contains("one of debug, info, warning, error"), error);
}

} // namespace log_test
