// SPDX-License-Identifier: MIT
// Counters of the player about its stream.
#include <memory>
#include <utility>

#include <doctest/doctest.h>

#include <tactor/player.hpp>

#include "player_support.hpp"
#include "rig.hpp"
#include "scores.hpp"

namespace counters_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Reports n ms for its n-th xrun.
class dry_sink final : public forwarding_sink {
public:
    using forwarding_sink::forwarding_sink;
    std::int64_t xrun_ns() noexcept override { return ++xruns_ * 1'000'000; }

private:
    std::int64_t xruns_ = 0;
};

} // namespace

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

TEST_CASE("a device that does not stamp its stop still gives the length of an xrun")
{
    rig r;
    r.play(960);
    r.dac.advance(1 << 20);
    r.step();
    REQUIRE(r.link.count.xruns == 1);
    // Virtual frames in real nanoseconds: only a bound can be checked.
    CHECK(r.link.count.xrun_ns[0] >= 0);
    CHECK(r.link.count.xrun_ns[0] < 60'000'000'000);
}

TEST_CASE("stats of a stream that never ran dry")
{
    player p(open_alsa(nine()), preset_array("palm-3x3"), {.realtime = false});
    CHECK_FALSE(p.ended());
    p.stop();
    REQUIRE(p.ended());
    CHECK(p.ended()->why.empty());
    const player_stats s = p.stats();
    CHECK(s.xruns == 0);
    CHECK(s.xrun_s.empty());
    CHECK_FALSE(s.realtime);
    CHECK(s.frames > 0);
    CHECK(s.ring_low_water == 0); // no stroke was fed
}

} // namespace counters_test
