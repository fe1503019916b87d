// SPDX-License-Identifier: MIT
// Faults in any order.
#include <random>

#include <doctest/doctest.h>

#include "rig.hpp"

namespace chance_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("random faults: every stroke ends once")
{
    std::mt19937_64 random(77);
    for (int round = 0; round < 200; ++round) {
        CAPTURE(round);
        rig r({.ring = std::size_t{8} << random() % 8});
        for (int i = 0; i < 400 && !r.loop.over(); ++i) {
            if (random() % 20 == 0)
                r.submit(random_score(random(), 1 + random() % 5),
                         random() % 2 == 0 ? 0 : r.status().written + random() % 30'000);
            if (random() % 30 == 0 && r.last_id > 0)
                r.feed.cancel({1 + static_cast<std::uint32_t>(random() % r.last_id)});
            switch (random() % 200) {
            case 0:
                r.dac.advance(5000);
                break;
            case 1:
                r.dac.suspend();
                break;
            case 2:
                if (random() % 4 == 0)
                    r.dac.disconnect();
                break;
            case 3:
                r.stop();
                break;
            default:
                if (random() % 8 == 0)
                    r.dac.wake(random() % 2 == 0);
                break;
            }
            if (random() % 10 != 0)
                r.dac.advance_queued(96);
            r.step();
            if (random() % 3 != 0)
                r.control();
        }
        r.stop();
        r.dac.wake(true);
        for (int i = 0; i < 1000 && !r.feed.stream_over(); ++i)
            r.play(96);
        r.control();
        CHECK(r.feed.stream_over());
        CHECK(r.ended.size() == r.last_id);
        for (const auto& [id, reports] : r.ended)
            REQUIRE(reports.size() == 1);
    }
}

} // namespace chance_test
