// SPDX-License-Identifier: MIT
// Drive time of an array: it outlives the player.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <thread>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "caught.hpp"
#include "clock_runner.hpp"
#include "player_support.hpp"
#include "rt/clock.hpp"
#include "scores.hpp"

namespace drive_history_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Allows a second in an hour: no test takes so long that time itself gives it back.
player_options one_second()
{
    player_options o = patient();
    o.limits.max_drive_s = 1.0;
    o.limits.window_s = 3600.0;
    return o;
}

std::uint64_t count_cuts(const player_options& o, double seconds, drive_history& after, unsigned tactor = 0)
{
    dac_player p(o);
    {
        const running_clock clock(p.dac);
        p.wait(p.submit(tone(seconds, tactor)));
    }
    p.dac.disconnect();
    p.stop();
    after = p.history();
    return p.stats().drives_cut;
}

} // namespace

TEST_CASE("a device that is lost and opened again does not give a tactor its time back")
{
    player_options o = one_second();
    drive_history h;
    CHECK(count_cuts(o, 0.7, h) == 0);
    drive_history ignored;
    CHECK(count_cuts(o, 0.7, ignored) == 0); // without the history the next player counts from zero
    o.driven = h;
    drive_history third;
    CHECK(count_cuts(o, 0.2, third) == 0);
    CHECK(count_cuts(o, 0.7, ignored) == 1);
    CHECK(count_cuts(o, 0.7, ignored, 1) == 0); // another tactor has had none
    o.driven = third;
    CHECK(count_cuts(o, 0.2, ignored) == 1); // 0.7 + 0.2 + 0.2 s, over three players
}

TEST_CASE("a running stream refuses to give its history")
{
    dac_player p(one_second());
    CHECK_THROWS_WITH_AS(static_cast<void>(p.history()), doctest::Contains("stop() it first"), error);
    const running_clock clock(p.dac);
    p.stop();
    CHECK_NOTHROW(static_cast<void>(p.history()));
    CHECK_NOTHROW(static_cast<void>(p.history()));
}

TEST_CASE("drive time goes through a text to another process")
{
    player_options o = one_second();
    drive_history h;
    CHECK(count_cuts(o, 0.7, h) == 0);
    CHECK_FALSE(h.empty());
    drive_history ignored;
    o.driven = drive_history::restore(h.save());
    CHECK_FALSE(o.driven.empty());
    CHECK(count_cuts(o, 0.2, ignored) == 0);
    CHECK(count_cuts(o, 0.4, ignored) == 1);
    CHECK(count_cuts(o, 0.7, ignored, 1) == 0);
    CHECK(drive_history::restore(drive_history().save()).empty());
}

TEST_CASE("a plan's drive time counts only until now when its process died early")
{
    player_options o = patient();
    o.limits.max_drive_s = 600.0;
    o.limits.window_s = 3600.0;
    const drive_history ahead = drive_history().with_ahead(9, 3000.0);
    drive_history ignored;
    o.driven = drive_history::restore(ahead.save());
    CHECK(count_cuts(o, 0.9, ignored) == 0); // the 3000 s do not count
    const std::int64_t enough_ns = rt::monotonic_ns() + 100'000'000;
    while (rt::monotonic_ns() < enough_ns)
        std::this_thread::yield();
    o.limits.max_drive_s = 0.1;
    o.driven = drive_history::restore(ahead.save());
    CHECK(count_cuts(o, 0.05, ignored) == 1);
    CHECK_THROWS_WITH_AS(static_cast<void>(ahead.with_ahead(9, -1.0)),
                         "drive history: -1 s ahead (give 0 to 86400 s)", error);
    CHECK_THROWS_WITH_AS(static_cast<void>(ahead.with_ahead(16385, 1.0)),
                         "drive history: 16385 channels (give 0 to 16384)", error);
    CHECK(caught_field([&] { static_cast<void>(ahead.with_ahead(9, -1.0)); }) == "ahead_s");
    CHECK(caught_field([&] { static_cast<void>(ahead.with_ahead(16385, 1.0)); }) == "channels");
}

TEST_CASE("histories of one array add up")
{
    player_options o = one_second();
    drive_history one;
    drive_history two;
    CHECK(count_cuts(o, 0.9, one) == 0);
    CHECK(count_cuts(o, 0.9, two, 1) == 0);
    CHECK(drive_history().with(one).save() == one.save());
    CHECK(one.with(drive_history()).save() == one.save());
    drive_history ignored;
    o.driven = one.with(two);
    CHECK(count_cuts(o, 0.2, ignored) == 1);
    CHECK(count_cuts(o, 0.2, ignored, 1) == 1);
    CHECK(count_cuts(o, 0.2, ignored, 2) == 0);
}

TEST_CASE("a text that is incomplete or foreign is refused; one from before the last boot is empty")
{
    player_options o = one_second();
    drive_history h;
    CHECK(count_cuts(o, 0.3, h) == 0);
    const std::string text = h.save();
    for (std::size_t n = 0; n < text.size(); ++n) {
        CAPTURE(n);
        CHECK_THROWS_AS(static_cast<void>(drive_history::restore(text.substr(0, n))), error);
    }
    const auto refused = [&](std::string_view what, std::string_view by) {
        std::string other = text;
        other.replace(other.find(what), what.size(), by);
        return caught_message([&] { static_cast<void>(drive_history::restore(other)); });
    };
    CHECK(refused("tactor-driven", "somebody else") ==
          "drive history: the text is something else (begin with an empty one)");
    CHECK(refused("\n0 ", "\n9 ") == "drive history: channels are not in order (begin with an empty one)");
    CHECK(refused("\n0 ", "\n-1 ") == "drive history: channels are not in order (begin with an empty one)");
    CHECK(refused("\n0 ", "\n0 x ") == "drive history: a word is no number (begin with an empty one)");
    CHECK(refused("\nend", " 5\nend") == "drive history: a line breaks off (begin with an empty one)");
    CHECK(refused("\n0 ", "\n0 1 9 8 0 ") ==
          "drive history: times are not in order (begin with an empty one)");
    CHECK(refused("\n0 ", "\n0 1 7 8 2 ") ==
          "drive history: times are not in order (begin with an empty one)");
    const std::size_t boot = text.find(' ', text.find(' ') + 1) + 1;
    std::string before = text;
    before.replace(boot, 4, "0000");
    CHECK(drive_history::restore(before).empty());
}

} // namespace drive_history_test
