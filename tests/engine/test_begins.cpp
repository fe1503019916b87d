// SPDX-License-Identifier: MIT
// Handlers of beginnings: which strokes they get, and the time of the first sample at the DAC.
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "player_support.hpp"
#include "scores.hpp"

namespace begins_test {

using namespace tactor;
using namespace tactor::test;

TEST_CASE("each stroke's beginning is reported once and before its end, with the time that its report has")
{
    std::mutex mutex;
    std::map<stroke_id, std::vector<std::optional<std::int64_t>>> begun;
    std::map<stroke_id, bool> ended;
    dac_player p;
    bool before = true;
    p.on_begin([&](stroke_id id, std::optional<std::int64_t> at_ns) {
        const std::lock_guard lock(mutex);
        before = before && !ended[id];
        begun[id].push_back(at_ns);
    });
    p.on_report([&](const stroke_report& r) {
        const std::lock_guard lock(mutex);
        ended[r.id] = true;
    });
    const running_clock clock(p.dac);
    const live_stroke live = p.begin({.timeout_s = 86400.0});
    CHECK(live.id().number != 0);
    std::vector<stroke_id> ids{live.id()};
    auto moved = live;
    REQUIRE(moved.to(20.0, 20.0));
    for (unsigned i = 1; i < 20; ++i)
        ids.push_back(p.submit(random_score(i, 3)));
    const stroke_id waits = p.submit(random_score(99, 3), start_at::trigger());
    for (std::size_t i = 1; i < ids.size(); ++i) {
        const auto r = p.wait(ids[i]);
        REQUIRE(r);
        CHECK(r->state == state_kind::finished);
    }
    moved.end();
    p.wait(live.id());
    p.cancel(waits);
    p.wait(waits);
    p.stop();
    const std::lock_guard lock(mutex);
    CHECK(before);
    CHECK(begun.size() == ids.size());
    for (const stroke_id id : ids)
        CHECK(begun[id].size() == 1);
    CHECK_FALSE(begun.contains(waits));
}

TEST_CASE("a handler of beginnings that throws ends the stream, as others do")
{
    dac_player p;
    p.on_begin([](stroke_id, std::optional<std::int64_t>) { throw 1; });
    const running_clock clock(p.dac);
    // An endless one: another may have finished before the handler is called.
    const live_stroke live = p.begin({.timeout_s = 86400.0});
    auto moved = live;
    REQUIRE(moved.to(20.0, 20.0));
    const auto r = p.wait(live.id());
    REQUIRE(r);
    CHECK(r->state == state_kind::interrupted);
    p.stop();
    CHECK(p.ended()->why.find("handler") != std::string::npos);
}

} // namespace begins_test
