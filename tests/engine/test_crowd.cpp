// SPDX-License-Identifier: MIT
// Many strokes at once: they play, or are reported as too many.
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <tactor/plan.hpp>

#include "has.hpp"
#include "rig.hpp"

namespace crowd_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr int crowd = 400;

score drawn(algorithm_kind how)
{
    plan_options o;
    o.algorithm = how;
    const array a = palm();
    render_options r;
    r.level_dbfs = -60.0;
    return {a, {{.plan = make_plan(a, preset_stroke("park2016-1"), o), .start_s = {}}}, r};
}

// Every tactor of 64 at once, twice.
score broad()
{
    plan p;
    burst b;
    b.duration_s = 0.1;
    for (unsigned i = 0; i < 64; ++i)
        b.drives.push_back({.tactor = i, .amplitude = 1.0});
    p.bursts.push_back(b);
    b.onset_s = 0.05;
    p.bursts.push_back(b);
    p.total_s = 0.15;
    p.stroke_duration_s = 0.15;
    render_options r;
    r.level_dbfs = -60.0;
    return {make_grid("8x8", 8, 8, 20.0, 20.0), p, r};
}

// Counts strokes by the state and reason of their end.
std::map<std::string, int> play_at_once(const score& s, std::uint64_t at, int strokes = crowd)
{
    rig_options o;
    o.channels = s.channels();
    rig r(o);
    for (int i = 0; i < strokes; ++i)
        r.submit(s, at);
    r.play_out();
    std::map<std::string, int> ends;
    for (const auto& [id, reports] : r.ended)
        for (const stroke_report& e : reports)
            ++ends[std::string(to_string(e.state)) + (e.late_s > 0.0 ? " late" : "") + ": " + e.why];
    return ends;
}

} // namespace

TEST_CASE("400 strokes at once all play")
{
    for (const algorithm_kind how : {algorithm_kind::park2016, algorithm_kind::continuous}) {
        for (const std::uint64_t at : {0, 48'000}) {
            CAPTURE(to_string(how));
            CAPTURE(at);
            CHECK(play_at_once(drawn(how), at) == std::map<std::string, int>{{"finished: ", crowd}});
        }
    }
}

TEST_CASE("64 continuous strokes wake the control side in few of the periods")
{
    rig r;
    for (int i = 0; i < 64; ++i)
        r.submit(drawn(algorithm_kind::continuous), 0);
    r.link.to_control.consume();
    int periods = 0;
    int wakes = 0;
    for (; r.ended.size() < 64 && periods < 10'000; ++periods) {
        r.dac.advance_queued(r.options.period);
        r.step();
        if (r.link.to_control.consume() > 0) {
            r.control();
            ++wakes;
        }
    }
    CHECK(periods > 400);
    CHECK(wakes < periods / 3);
    for (const auto& [id, reports] : r.ended)
        CHECK(r.end(id).state == state_kind::finished);
}

TEST_CASE("strokes beyond the mixer's space are reported as too many, with a hint")
{
    int refused = 0;
    for (const auto& [end, n] : play_at_once(broad(), 48'000)) {
        if (end.starts_with("finished"))
            continue;
        CHECK(has(end, "interrupted"));
        CHECK(has(end, "too many strokes at once (let fewer overlap"));
        refused += n;
    }
    CHECK(refused > 0);
    CHECK(refused < crowd);
}

TEST_CASE("strokes beyond the ring's space are reported as too many, not as a slow computer")
{
    const score s = drawn(algorithm_kind::tactile_brush);
    for (const auto& [strokes, at] : {std::pair(1000, 0), std::pair(4000, 48'000)}) {
        CAPTURE(strokes);
        int refused = 0;
        for (const auto& [end, n] : play_at_once(s, static_cast<std::uint64_t>(at), strokes)) {
            if (end.starts_with("finished"))
                continue;
            has(end, "too many strokes at once (let fewer overlap");
            refused += n;
        }
        CHECK(refused > strokes / 2);
    }
}

} // namespace crowd_test
