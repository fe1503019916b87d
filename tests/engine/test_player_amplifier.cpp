// SPDX-License-Identifier: MIT
// The player's threads and an amplifier: on a paced null PCM in real time, or on a DAC that stands still.
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include <doctest/doctest.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "player_support.hpp"
#include "scores.hpp"

namespace player_amplifier_test {

using namespace tactor;
using namespace tactor::test;

namespace {

struct line_state {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<bool> log;
    bool works = true;

    void await(std::size_t n)
    {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return log.size() >= n; });
    }
};

class watched_line final : public enable_line {
public:
    explicit watched_line(std::shared_ptr<line_state> s) : state_(std::move(s)) {}
    bool set(bool on) noexcept override
    {
        const std::lock_guard lock(state_->mutex);
        state_->log.push_back(on);
        state_->changed.notify_all();
        return state_->works;
    }

private:
    std::shared_ptr<line_state> state_;
};

player_lines with(const std::shared_ptr<line_state>& s)
{
    player_lines l{.amplifier = std::make_unique<watched_line>(s)};
    return l;
}

class any_line final : public enable_line {
public:
    bool set(bool) noexcept override { return true; }
};

player_lines slow_amplifier()
{
    player_lines l{.amplifier = std::make_unique<any_line>(), .settle_s = 600.0};
    return l;
}

// Only a failure takes so long.
constexpr double long_enough_s = 60.0;

} // namespace

TEST_CASE("the amplifier waits until the DAC has played for the given time")
{
    const auto state = std::make_shared<line_state>();
    player_lines l = with(state);
    l.proof_s = 0.3;
    player p(open_alsa(nine()), palm(), patient(), std::move(l));
    state->await(1);
    CHECK(p.position().played >= 14400);
    p.stop();
    CHECK(state->log == std::vector<bool>{true, false});
}

TEST_CASE("the player switches its amplifier on once, plays, and off once")
{
    const auto state = std::make_shared<line_state>();
    std::uint64_t stalls = 0;
    {
        player p(open_alsa(nine()), palm(), {}, with(state));
        const auto report = p.wait(p.submit(tone(0.05)));
        REQUIRE(report);
        state->await(1);
        p.stop();
        stalls = p.stats().stalls;
        // On a busy machine the watchdog may have acted.
        if (stalls == 0)
            CHECK(report->state == state_kind::finished);
    }
    CHECK_FALSE(state->log.back());
    if (stalls == 0)
        CHECK(state->log == std::vector<bool>{true, false});
    for (std::size_t i = 0; i < state->log.size(); ++i)
        CHECK(state->log[i] == (i % 2 == 0));
}

TEST_CASE("a player destroyed at any moment leaves its amplifier off")
{
    for (int i = 0; i < 20; ++i) {
        const auto state = std::make_shared<line_state>();
        {
            player p(open_alsa(nine()), palm(), {}, with(state));
            p.submit(tone(0.01));
            if (i % 2 == 1)
                state->await(1);
        }
        CHECK((state->log.empty() || !state->log.back()));
    }
}

TEST_CASE("an amplifier whose line fails ends the player's stream")
{
    const auto state = std::make_shared<line_state>();
    state->works = false;
    player p(open_alsa(nine()), palm(), {}, with(state));
    std::string why;
    try {
        const auto report = p.wait(p.submit(tone(0.05)));
        REQUIRE(report);
        CHECK(report->state == state_kind::interrupted);
        why = report->why;
    } catch (const error& e) {
        why = e.what(); // the stream was over before the stroke came
    }
    CHECK(why.find("the amplifier's line cannot be switched") != std::string::npos);
    p.stop();
    CHECK_THROWS_AS(p.submit(tone(0.05)), error);
    // It refuses to go off as well.
    REQUIRE(p.ended());
    CHECK(p.ended()->reason == reason_kind::left_on);
    CHECK(p.ended()->why == "the amplifier's line cannot be switched off: it may be on");
    CHECK(p.stats().left_on);
    // Each try but the first was to switch it off. The last one is counted a moment later.
    const auto tries = [&] {
        const std::lock_guard lock(state->mutex);
        return state->log.size();
    };
    while (p.stats().off_failures != tries() - 1)
        std::this_thread::yield();
}

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

} // namespace player_amplifier_test
