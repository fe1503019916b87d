// SPDX-License-Identifier: MIT
// Scores for another array than the player's: scores that lose or exceed something are refused, the rest
// play.
#include <cstddef>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/plan.hpp>
#include <tactor/player.hpp>
#include <tactor/stroke.hpp>

#include "caught.hpp"
#include "clock_runner.hpp"
#include "has.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "sink/alsa/adopt.hpp"

namespace fitting_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Returns palm() without its last tactors.
array first_of_palm(std::size_t tactors)
{
    array a = palm();
    a.tactors.resize(tactors);
    return a;
}

// Returns palm() with a lower limit on one tactor.
array palm_with_limit(std::size_t tactor, double max_dbfs)
{
    array a = palm();
    a.tactors[tactor].max_dbfs = max_dbfs;
    return a;
}

render_options on_nine_channels(double level_dbfs = -12.0)
{
    render_options o;
    o.channels = 9;
    o.level_dbfs = level_dbfs;
    return o;
}

// Makes one burst on a tactor of palm().
score burst_on(unsigned tactor, const render_options& o, double amplitude = 1.0)
{
    plan p;
    burst b;
    b.duration_s = 0.01;
    b.drives = {{.tactor = tactor, .amplitude = amplitude}};
    p.bursts.push_back(std::move(b));
    p.total_s = 0.01;
    p.stroke_duration_s = 0.01;
    return {palm(), std::move(p), o};
}

score continuous(const array& a)
{
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    stroke s = preset_stroke("park2016-1");
    s.motion = s.motion.with_duration(0.2);
    return {a, make_plan(a, s, o), on_nine_channels()};
}

// Returns the error of a player with this array for a score; "" where it plays it to its end.
std::string complaint(const array& a, const score& s)
{
    fake_dac dac;
    const running_clock clock(dac);
    player p(alsa::adopt(dac.pcm(), nine()), a, patient());
    try {
        const auto r = p.wait(p.submit(s));
        REQUIRE(r);
        CHECK(r->state == state_kind::finished);
        return "";
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        return e.what();
    }
}

// Returns the field that a player of nine channels at 48 kHz refuses.
std::string refused_field(const score& s)
{
    clocked_player p;
    return caught_field([&] { p.submit(s); });
}

} // namespace

TEST_CASE("a score of another rate or of other channels than the stream's is refused by the one that differs")
{
    const auto with = [](unsigned channels, unsigned rate) {
        render_options o = on_nine_channels();
        o.channels = channels;
        o.rate = rate;
        return refused_field(burst_on(0, o));
    };
    CHECK(with(9, 44100) == "rate");
    CHECK(with(10, 48000) == "channels");
    CHECK(with(10, 44100).empty());
}

TEST_CASE("a score that drives a channel without a tactor is refused, others play")
{
    const array few = first_of_palm(4);
    CHECK(complaint(few, burst_on(3, on_nine_channels())).empty());
    CHECK(complaint(few, burst_on(4, on_nine_channels())) ==
          "stroke: it drives tactor 4 on channel 4, where the player's array has none (plan it for the array "
          "that the player was opened with)");
    CHECK(complaint(few, burst_on(4, on_nine_channels(), 0.0)).empty());
    has(complaint(few, random_score(1, 20, 9)), "where the player's array has none");
}

TEST_CASE("a continuous stroke counts every tactor of its array as driven")
{
    CHECK(complaint(palm(), continuous(palm())).empty());
    has(complaint(first_of_palm(8), continuous(palm())), "it drives tactor 8 on channel 8, where");
}

TEST_CASE("a score that drives a tactor above the player's limit is refused, with both levels")
{
    const array careful = palm_with_limit(2, -30.0);
    CHECK(complaint(careful, burst_on(2, on_nine_channels())) ==
          "stroke: it drives tactor 2 at up to -12 dBFS, but the player's array allows -30 dBFS on channel 2 "
          "(plan it for the array that the player was opened with)");
    CHECK(complaint(careful, burst_on(1, on_nine_channels())).empty());
    CHECK(complaint(careful, burst_on(2, on_nine_channels(-30.0))).empty());
    has(complaint(careful, burst_on(2, on_nine_channels(-29.9))), "at up to -29.9 dBFS");
    has(complaint(careful, continuous(palm())), "at up to -12 dBFS");
}

TEST_CASE("a score planned within the same limits plays, whatever its peaks are known to be")
{
    // The bound on two continuous strokes at once is above their limit, since both may be at one place.
    array a = palm();
    for (tactor_spec& t : a.tactors)
        t.max_dbfs = -12.0;
    plan_options o;
    o.algorithm = algorithm_kind::continuous;
    const auto across = [&](double y) {
        const stroke s{.motion = trajectory::timed({{0.0, {0.0, y}}, {0.1, {40.0, y}}})};
        return make_plan(a, s, o);
    };
    const score two(a, {{across(0.0), 0.0, {}}, {across(40.0), 0.0, {}}}, on_nine_channels());
    CHECK(complaint(a, two).empty());
    has(complaint(palm_with_limit(0, -20.0), two), "but the player's array allows -20 dBFS on channel 0");
}

TEST_CASE("a marker on a tactor's channel is refused, on a spare channel it plays")
{
    render_options o = on_nine_channels();
    o.marker_channel = 8;
    const array eight = first_of_palm(8);
    const score s(eight, make_plan(eight, preset_stroke("park2016-1")), o);
    CHECK(complaint(eight, s).empty());
    CHECK(complaint(palm(), s) == "stroke: its marker is on channel 8, where the player's array has a tactor "
                                  "(choose a spare channel for it)");
    CHECK(refused_field(s) == "marker_channel");
}

} // namespace fitting_test
