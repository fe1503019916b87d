// SPDX-License-Identifier: MIT
// cancel() and stop() with the player's threads, while the amplifier settles for ever: the DAC's clock stands
// still.
#include <chrono>
#include <memory>

#include <doctest/doctest.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "player_support.hpp"
#include "scores.hpp"

namespace waiting_player_test {

using namespace tactor;
using namespace tactor::test;

namespace {

class any_line final : public enable_line {
public:
    bool set(bool) noexcept override { return true; }
};

player_lines slow_amplifier()
{
    player_lines l;
    l.amplifier = std::make_unique<any_line>();
    l.settle_s = 600.0;
    return l;
}

// Only a failure takes so long.
constexpr double long_enough_s = 60.0;

} // namespace

TEST_CASE("cancel() is reported without a frame being played")
{
    dac_player p(patient(), slow_amplifier());
    const stroke_id score = p.submit(tone(1.0));
    const live_stroke live = p.begin({.timeout_s = 86400.0});
    CHECK_FALSE(p.wait(score, 1e-9));
    CHECK(p.cancel(score));
    CHECK(p.cancel(live.id()));
    for (const stroke_id id : {score, live.id()}) {
        const auto r = p.wait(id, long_enough_s);
        REQUIRE(r);
        CHECK(r->state == state_kind::cancelled);
        CHECK(r->frames == 0);
    }
    CHECK(p.position().played == 0);
    const running_clock clock(p.dac);
    p.stop();
}

TEST_CASE("stop() reports waiting strokes before the amplifier has settled")
{
    dac_player p(patient(), slow_amplifier());
    const stroke_id score = p.submit(tone(1.0));
    const live_stroke live = p.begin({.timeout_s = 86400.0});
    const running_clock clock(p.dac);
    const auto before = std::chrono::steady_clock::now();
    p.stop();
    CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(300)); // of 600
    for (const stroke_id id : {score, live.id()}) {
        const auto r = p.wait(id, long_enough_s);
        REQUIRE(r);
        CHECK(r->state == state_kind::cancelled);
    }
}

} // namespace waiting_player_test
