// SPDX-License-Identifier: MIT
// Start times: the first sample at the DAC of every stroke that sounded.
#include <cmath>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/player.hpp>

#include "live_rig.hpp"
#include "player_support.hpp"
#include "rig.hpp"
#include "rt/clock.hpp"

namespace started_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Returns a period of the rig, ns: each step plays one, and the clock moves as much.
double period_ns(rig& r)
{
    return 1e9 * r.options.period / r.options.sample_rate;
}

// Returns the time of a frame of the current epoch at the virtual DAC, ns.
double true_time(rig& r, std::uint64_t frame)
{
    const auto ahead = static_cast<double>(frame) - static_cast<double>(r.status().played);
    return static_cast<double>(r.now) + ahead * 1e9 / r.options.sample_rate;
}

void check_started(rig& r, stroke_id id, double when)
{
    REQUIRE(r.end(id).started_ns);
    CHECK(std::abs(static_cast<double>(*r.end(id).started_ns) - when) < period_ns(r));
}

// A sink without a position as long as it is shy.
class shy_sink : public forwarding_sink {
public:
    shy_sink(std::unique_ptr<sink> s, const bool& shy) : forwarding_sink(std::move(s)), shy_(shy) {}
    stream_position position() noexcept override
    {
        stream_position p = forwarding_sink::position();
        p.valid = p.valid && !shy_;
        return p;
    }

private:
    const bool& shy_;
};

} // namespace

TEST_CASE("the first stroke of a player, submitted before the clock is known, has its start")
{
    for (const unsigned period : {32U, 96U, 1024U}) {
        CAPTURE(period);
        rig r({.period = period, .started = false});
        const stroke_id id = r.submit(tone(0.1));
        REQUIRE(r.start().status == io_kind::ok);
        CHECK_FALSE(r.link.clock.load().valid());
        r.play_out();
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).late_s == 0.0);
        check_started(r, id, true_time(r, *r.first_sound() - 1)); // a sine begins with a zero
    }
}

TEST_CASE("a stroke as short as a frame or as a period has its start, one without sound has none")
{
    rig r;
    const stroke_id frame = r.submit(tone(1.0 / rate));
    const stroke_id period = r.submit(tone(96.0 / rate));
    const stroke_id nothing = r.submit(score(palm(), {}, {}));
    r.play_out();
    for (const stroke_id id : {frame, period})
        CHECK(r.end(id).started_ns.has_value());
    CHECK_FALSE(r.end(nothing).started_ns.has_value());
}

TEST_CASE("strokes that are cut report their start, those that never sounded report none")
{
    rig r({.started = false});
    const stroke_id cancelled = r.submit(tone(5.0));
    const stroke_id cut = r.submit(tone(5.0));
    const stroke_id waiting = r.submit(tone(0.1), start_at::frame(480'000));
    const stroke_id armed = r.submit(tone(0.1), start_at::trigger());
    REQUIRE(r.start().status == io_kind::ok);
    r.play(960);
    const double when = true_time(r, *r.first_sound() - 1);
    r.feed.cancel(cancelled);
    r.feed.cancel(waiting);
    r.feed.cancel(armed);
    r.play(4800);
    check_started(r, cancelled, when);
    CHECK(r.end(cancelled).state == state_kind::cancelled);
    r.dac.advance(4800); // runs dry
    r.play(960);
    check_started(r, cut, when);
    CHECK(r.end(cut).state == state_kind::interrupted);
    for (const stroke_id id : {waiting, armed})
        CHECK_FALSE(r.end(id).started_ns.has_value());
}

TEST_CASE("an xrun before the DAC's position was ever read keeps the start")
{
    bool shy = true;
    rig_options o;
    o.wrap = [&shy](std::unique_ptr<sink> s) { return std::make_unique<shy_sink>(std::move(s), shy); };
    rig r(o);
    const std::int64_t begin = r.now;
    const stroke_id id = r.submit(tone(5.0));
    r.play(960);
    const std::uint64_t first = *r.first_sound() - 1;
    r.dac.advance(4800);
    shy = false;
    r.play(960);
    CHECK(r.end(id).state == state_kind::interrupted);
    check_started(r, id, static_cast<double>(begin) + static_cast<double>(first) * 1e9 / rate);
}

TEST_CASE("the start of a stroke after an xrun is in the clock of its epoch")
{
    rig r;
    r.play(9600);
    r.dac.advance(4800); // runs dry, and stands for a second
    r.now += 1'000'000'000;
    const stroke_id id = r.submit(tone(0.1));
    const std::uint64_t from = r.dac.captured_frames();
    r.play(96);
    const std::uint64_t epoch = r.status().written - r.dac.captured_frames();
    r.play_out();
    check_started(r, id, true_time(r, epoch + *r.first_sound(from) - 1));
}

TEST_CASE("a live stroke reports when its first point was felt")
{
    live_rig r;
    r.play(960);
    CHECK(r.live->to({20.0, 20.0}, 1.0));
    r.play(960);
    r.live->voice.request(engine::live_voice::action::end);
    r.play_out();
    REQUIRE(r.first_sound());
    check_started(r, r.live->id, true_time(r, *r.first_sound() - 1));
}

TEST_CASE("every stroke played on null has its start, the first of each player too")
{
    for (int n = 0; n < 10; ++n) {
        CAPTURE(n);
        const std::int64_t before = rt::monotonic_ns();
        player p(open_alsa(nine()), palm());
        for (int k = 0; k < 2; ++k) {
            const auto r = p.wait(p.submit(tone(0.005)));
            REQUIRE(r);
            CHECK(r->state == state_kind::finished);
            REQUIRE(r->started_ns);
            CHECK(*r->started_ns > before);
            CHECK(*r->started_ns < rt::monotonic_ns());
        }
    }
}

} // namespace started_test
