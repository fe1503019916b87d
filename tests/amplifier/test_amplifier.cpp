// SPDX-License-Identifier: MIT
// The amplifier's state machine alone: tables of events and the line's state after each.
#include "amplifier/amplifier.hpp"

#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace amplifier_test {

using tactor::amplifier::sequence;
using tactor::amplifier::sequence_options;
using event = tactor::amplifier::event;

namespace {

constexpr std::int64_t ms = 1'000'000;

struct row {
    std::int64_t at_ms;
    event what;
    std::uint64_t frames;
    bool line;
    bool ready;
    std::uint64_t sounds_until = 0;
};

sequence_options options()
{
    return {.settle_ns = 10 * ms, .proof_frames = 192, .calm_ns = 1000 * ms, .most_xruns = 2};
}

// The line follows at once.
void run(const std::vector<row>& table)
{
    sequence a(options());
    for (std::size_t i = 0; i < table.size(); ++i) {
        const row& r = table[i];
        const bool before = a.line();
        a.handle(r.what, r.at_ms * ms, {r.frames, r.sounds_until});
        if (a.line() && !before)
            a.handle(event::switched, r.at_ms * ms);
        CAPTURE(i);
        CHECK(a.line() == r.line);
        CHECK(a.ready() == r.ready);
    }
}

const std::vector<row> to_ready{
    {0, event::tick, 0, false, false},   {1, event::started, 0, false, false},
    {2, event::moved, 96, false, false}, {3, event::moved, 191, false, false},
    {4, event::moved, 192, true, false}, {13, event::moved, 700, true, false},
    {14, event::tick, 0, true, true},
};

/// The time of silence is not known yet.
constexpr std::uint64_t unknown = UINT64_MAX;

std::vector<row> after_ready(std::vector<row> more)
{
    std::vector<row> all = to_ready;
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

} // namespace

TEST_CASE("it does not switch on again into sound from before the mute")
{
    run(after_ready({
        {100, event::moved, 4800, true, true, 96'000},
        {101, event::lapsed, 0, false, false},
        {102, event::moved, 4896, false, false, unknown},
        {106, event::moved, 5088, false, false, unknown},
        {108, event::moved, 5184, false, false, 6000},
        {126, event::moved, 6191, false, false, 6000},
        {127, event::moved, 6192, true, false, 6000},
        {137, event::tick, 0, true, true},
    }));
}

TEST_CASE("amplifier: the DAC runs, two periods are played, on, settled, ready")
{
    run(to_ready);
}

TEST_CASE("amplifier: silence and a failure are off for good")
{
    for (const event e : {event::silent, event::failed}) {
        run(after_ready({{20, e, 0, false, false},
                         {21, event::started, 0, false, false},
                         {22, event::moved, 9999, false, false},
                         {9000, event::tick, 0, false, false}}));
    }
}

TEST_CASE("amplifier: one xrun leaves it on, the second within a second mutes it for a second")
{
    run(after_ready({{100, event::xrun, 0, true, true},
                     {101, event::started, 0, true, true},
                     {1099, event::xrun, 0, false, false},
                     {1100, event::started, 0, false, false},
                     {1200, event::moved, 5000, false, false},
                     {2098, event::moved, 48000, false, false},
                     {2099, event::tick, 0, true, false},
                     {2109, event::tick, 0, true, true}}));
}

TEST_CASE("amplifier: xruns a second apart never mute it")
{
    run(after_ready({{100, event::xrun, 0, true, true},
                     {1100, event::xrun, 0, true, true},
                     {2100, event::xrun, 0, true, true},
                     {3100, event::xrun, 0, true, true}}));
}

TEST_CASE("amplifier: an xrun during a mute prolongs it")
{
    run(after_ready({{100, event::xrun, 0, true, true},
                     {200, event::xrun, 0, false, false},
                     {1100, event::xrun, 0, false, false},
                     {1101, event::started, 0, false, false},
                     {1900, event::moved, 9000, false, false},
                     {2100, event::tick, 0, true, false}}));
}

TEST_CASE("amplifier: a system that sleeps has it off, and on again in order")
{
    run(after_ready({{100, event::suspended, 0, false, false},
                     {5000, event::moved, 9000, false, false},
                     {5001, event::started, 0, false, false},
                     {5002, event::moved, 191, false, false},
                     {5004, event::moved, 200, true, false},
                     {5014, event::tick, 0, true, true}}));
}

TEST_CASE("amplifier: a stalled audio thread mutes it until two more periods were played")
{
    run(after_ready({{100, event::moved, 5000, true, true},
                     {200, event::stalled, 0, false, false},
                     {300, event::moved, 9000, false, false},
                     {400, event::recovered, 0, false, false},
                     {401, event::moved, 9191, false, false},
                     {402, event::moved, 9192, true, false},
                     {412, event::tick, 0, true, true}}));
}

TEST_CASE("amplifier: one that went off by itself comes back in order")
{
    run(after_ready({{100, event::moved, 5000, true, true},
                     {200, event::lapsed, 0, false, false},
                     {203, event::moved, 5192, true, false},
                     {213, event::tick, 0, true, true}}));
}

TEST_CASE("amplifier: deadlines are the times at which a tick changes something")
{
    sequence a(options());
    a.handle(event::started, 0);
    CHECK_FALSE(a.deadline());
    a.handle(event::moved, 5 * ms, {.played = 192});
    CHECK_FALSE(a.deadline());
    a.handle(event::switched, 7 * ms);
    CHECK(a.deadline() == 17 * ms);
    a.handle(event::tick, 17 * ms - 1);
    CHECK_FALSE(a.ready());
    a.handle(event::tick, 17 * ms);
    CHECK(a.ready());
    CHECK_FALSE(a.deadline());
}

TEST_CASE("amplifier: for any events, ready implies on, on comes after two periods, and the end is final")
{
    std::mt19937_64 random(7);
    for (int run = 0; run < 2000; ++run) {
        sequence a(options());
        std::int64_t now = 0;
        std::uint64_t played = 0;
        bool stopped = true;
        bool stalled = false;
        bool ended = false;
        for (int i = 0; i < 200; ++i) {
            now += static_cast<std::int64_t>(random() % 50) * ms;
            const auto e = static_cast<event>(random() % 40);
            if (e > event::tick) {
                if (!stopped)
                    played += 96;
                a.handle(event::moved, now, {.played = played});
            } else {
                if ((e == event::silent || e == event::failed) && random() % 8 != 0)
                    continue;
                if (e == event::started) {
                    stopped = false;
                    played = 0;
                }
                stopped = stopped || e == event::suspended;
                stalled = (stalled || e == event::stalled) && e != event::recovered;
                ended = ended || e == event::silent || e == event::failed;
                const bool before = a.line();
                a.handle(e, now, {.played = played});
                // Only a running DAC switches it on.
                if (a.line() && !before)
                    CHECK(played >= 192);
            }
            if (a.ready())
                REQUIRE(a.line());
            if (ended || stopped || stalled)
                REQUIRE_FALSE(a.line());
        }
    }
}

} // namespace amplifier_test
