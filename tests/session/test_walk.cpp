// SPDX-License-Identifier: MIT
// Answers of a walk, and the channel map that they give.
#include "session/walk.hpp"

#include <doctest/doctest.h>

namespace walk_test {

using namespace tactor;
using namespace tactor::session;

namespace {

array three()
{
    array a = make_grid("three", 1, 3, 20.0, 20.0);
    a.tactors[0].channel = 5;
    a.tactors[1].channel = 6;
    a.tactors[2].channel = 7;
    return a;
}

} // namespace

TEST_CASE("a channel belongs to the place where it was felt")
{
    // Channel 5 was felt at 1, 6 at 2, 7 at 0.
    const walk_map v = map_channels(three(), {1, 2, 0});
    CHECK(v.problems.empty());
    CHECK(v.changed);
    CHECK(v.channels == std::vector{7U, 5U, 6U});
}

TEST_CASE("answers that are all right change nothing")
{
    const walk_map v = map_channels(three(), {0, 1, 2});
    CHECK_FALSE(v.changed);
    CHECK(v.channels == std::vector{5U, 6U, 7U});
}

TEST_CASE("two felt at one place, and one felt nowhere, make no map")
{
    const walk_map v = map_channels(three(), {2, std::nullopt, 2});
    CHECK(v.channels.empty());
    CHECK(v.problems == std::vector<std::string>{
                            "tactor 1 (channel 6) was not felt",
                            "tactor 0 (channel 5) and tactor 2 (channel 7) were felt at one place, 2"});
    // The remaining place is a guess, not a finding.
    CHECK(map_channels(three(), {0, 1, std::nullopt}).channels.empty());
}

TEST_CASE("each tactor alone is driven, three times, at full intensity")
{
    const std::vector<placed_plan> all = walk_plans(three(), 200.0);
    REQUIRE(all.size() == 3);
    for (unsigned i = 0; i < 3; ++i) {
        const plan& p = all[i].plan;
        CHECK(p.carrier_hz == 200.0);
        REQUIRE(p.bursts.size() == 3);
        for (const burst& b : p.bursts) {
            CHECK(b.drives == std::vector<drive>{{i, 1.0}});
            CHECK(b.onset_s + b.duration_s <= p.total_s);
        }
    }
    CHECK(score(three(), all, {}).frames() == 3 * 31200);
}

TEST_CASE("the map shows each number at its place")
{
    CHECK(tactor_map_text(preset_array("palm-3x3")) ==
          "  0       1       2\n\n\n\n  3       4       5\n\n\n\n"
          "  6       7       8\n");
    array wide = make_grid("wide", 1, 32, 50.0, 50.0);
    const std::string line = tactor_map_text(wide);
    CHECK(line.size() <= 80);
    CHECK(line.find("30") != std::string::npos);
}

} // namespace walk_test
