// SPDX-License-Identifier: MIT
// What an array was given lately outlives the player that gave it.
#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

namespace drive_history_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// One second in an hour: no test takes so long that time itself would give it back.
player_options one_second()
{
    player_options o = patient();
    o.limits.max_drive_s = 1.0;
    o.limits.window_s = 3600.0;
    return o;
}

std::uint64_t cuts_of(const player_options& o, double seconds, drive_history& after, unsigned tactor = 0)
{
    fake_dac dac;
    player p(pcm::adopt(dac.pcm(), nine()), palm(), o);
    {
        const running_clock clock(dac);
        p.wait(p.submit(tone(seconds, tactor)));
    }
    dac.disconnect();
    p.stop();
    after = p.history();
    return p.stats().drives_cut;
}

} // namespace

TEST_CASE("a device that was lost and is opened again does not give a tactor its time back")
{
    player_options o = one_second();
    drive_history h;
    CHECK(cuts_of(o, 0.7, h) == 0);
    drive_history ignored;
    CHECK(cuts_of(o, 0.7, ignored) == 0); // without it the next counts from nothing
    o.driven = h;
    drive_history third;
    CHECK(cuts_of(o, 0.2, third) == 0);
    CHECK(cuts_of(o, 0.7, ignored) == 1);
    CHECK(cuts_of(o, 0.7, ignored, 1) == 0); // another tactor has had none
    o.driven = third;
    CHECK(cuts_of(o, 0.2, ignored) == 1); // 0.7 + 0.2 + 0.2 s, over three players
}

TEST_CASE("the history of a stream that goes on is not to be had")
{
    fake_dac dac;
    player p(pcm::adopt(dac.pcm(), nine()), palm(), one_second());
    CHECK_THROWS_WITH_AS(static_cast<void>(p.history()), doctest::Contains("stop() it first"), error);
    const running_clock clock(dac);
    p.stop();
    CHECK_NOTHROW(static_cast<void>(p.history()));
    CHECK_NOTHROW(static_cast<void>(p.history()));
}

} // namespace drive_history_test
