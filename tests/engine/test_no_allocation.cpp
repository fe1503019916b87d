// SPDX-License-Identifier: MIT
// Heap use: none in the audio thread; the feeder's does not grow with a score.
#include <cstdlib>
#include <utility>

#include <doctest/doctest.h>

#include "count_allocations.hpp"
#include "rig.hpp"
#include "rounds.hpp"

namespace no_allocation_test {

using namespace tactor;
using namespace tactor::test;

COUNTING_TEST_CASE("the audio loop calls the heap in none of 100 000 periods, xruns and cancels included")
{
    rig r;
    r.dac.reserve_capture(1 << 16);
    std::uint64_t calls = 0;
    const score strokes = random_score(1, 30);
    for (int i = 0; i < 100'000; ++i) {
        if (i % 700 == 0)
            r.submit(strokes, i % 1400 == 0 ? 0 : r.status().written + 5000);
        if (i % 1500 == 0)
            r.feed.cancel(r.last());
        if (i % 9000 == 8999)
            r.dac.advance(10'000);
        r.dac.advance_queued(96);
        {
            const count_allocations count;
            r.step();
            calls += count.calls();
        }
        r.control();
    }
    CHECK(calls == 0);
    CHECK(r.link.count.xruns == 11);
    CHECK(r.link.count.periods >= 100'000);
    CHECK(r.ended.size() > 100);
}

COUNTING_TEST_CASE("the counter counts")
{
    std::uint64_t calls = 0;
    std::int64_t held = 0;
    std::int64_t left = 0;
    {
        const count_allocations count;
        void* volatile p = std::malloc(400); // volatile: the compiler may leave out a pair of calls
        held = count.bytes();
        std::free(p);
        calls = count.calls();
        left = count.bytes();
    }
    CHECK(calls == 2);
    CHECK(held >= 400);
    CHECK(left == 0);
}

COUNTING_TEST_CASE("minutes of strokes, or an hour, need no more memory in the feeder than a second")
{
    const score hour = random_score(3, rounds(6'400, 51'000));
    REQUIRE(hour.frames() > static_cast<std::uint64_t>(rounds(430, 3500)) * rate);
    rig r;
    r.dac.reserve_capture(1 << 16);
    r.submit(hour);
    r.play(48'000);
    std::uint64_t calls = 0;
    std::uint64_t most_in_ring = 0;
    while (r.ended.empty()) {
        r.dac.advance_queued(96);
        r.step();
        engine::report report;
        while (r.link.reports.pop(report))
            r.feed.handle(report);
        {
            const count_allocations count;
            r.feed.pump(r.status().written);
            calls += count.calls();
        }
        most_in_ring = std::max<std::uint64_t>(most_in_ring, r.link.commands.size());
        for (const stroke_report& e : std::exchange(r.feed.reports(), {}))
            r.ended[e.id].push_back(e);
    }
    CHECK(calls == 0);
    CHECK(most_in_ring < 64);
    CHECK(r.end({1}).state == state_kind::finished);
    CHECK(r.end({1}).frames == hour.frames());
}

} // namespace no_allocation_test
