// SPDX-License-Identifier: MIT
// Streams one after the other: decisions of their policy, without a device and without a clock; lines that
// outlive the players that they are lent to; counters.
#include "session/device_stream.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include <doctest/doctest.h>

namespace device_stream_test {

using namespace tactor;
using namespace tactor::session;
using act = stream_policy::act;

namespace {

/// A policy, and what its owner does: an hour of it takes no time.
struct owner {
    stream_policy policy;
    double now_s = 0.0;

    explicit owner(const stream_times& t = {}) : policy(t) {}

    static stream_policy::time at(double s)
    {
        return stream_policy::time{} +
               std::chrono::round<stream_policy::time::duration>(std::chrono::duration<double>(s));
    }
    act step() { return policy.step(at(now_s)); }
    /// Waits until the policy has something to do; nothing: it waits for ever. Returns how long it took, s.
    std::optional<double> wait_for(act a)
    {
        const double began_s = now_s;
        while (step() != a) {
            if (!policy.next_step_time())
                return {};
            now_s = std::chrono::duration<double>(policy.next_step_time()->time_since_epoch()).count();
        }
        return now_s - began_s;
    }
    void open()
    {
        REQUIRE(step() == act::open);
        policy.begin();
        policy.on_open();
    }
    void fail()
    {
        policy.begin();
        policy.on_failure("not there");
    }
    void close(bool left_on = false)
    {
        REQUIRE(step() == act::close);
        policy.begin();
        policy.on_close(left_on);
    }
    void lose()
    {
        policy.on_end("it is gone");
        close();
    }
};

class line final : public enable_line {
public:
    line(bool& on, const bool& stuck) : on_(on), stuck_(stuck) {}
    bool set(bool on) noexcept override
    {
        if (stuck_)
            return false;
        on_ = on;
        return true;
    }

private:
    bool& on_;
    const bool& stuck_;
};

struct lent {
    bool on = false;
    bool stuck = false;
    int switched = 0;
    lent_lines lines{{.amplifier = std::make_unique<line>(on, stuck)}};

    lent()
    {
        lines.set_switch_handler([this] { ++switched; });
    }
};

player_stats one_of_each(double scale)
{
    const auto n = static_cast<std::uint64_t>(scale);
    player_stats s;
    s.periods = s.frames = s.xruns = s.limited_frames = s.power_limited_frames = s.drives_cut = s.stalls = n;
    s.off_failures = s.sync_pulses = s.sync_missed = s.minor_faults = s.major_faults = n;
    s.ring_low_water = n;
    s.sync_mean_late_s = s.sync_worst_late_s = s.latest_wakeup_s = scale;
    s.realtime = true;
    s.xrun_s = {scale};
    return s;
}

} // namespace

TEST_CASE("the device is opened at once, and runs")
{
    owner o;
    CHECK(o.policy.state() == stream_state::lost);
    CHECK_FALSE(o.policy.needs_proof());
    o.open();
    CHECK(o.policy.state() == stream_state::running);
    CHECK(o.step() == act::nothing);
    CHECK_FALSE(o.policy.next_step_time());
}

TEST_CASE("while the device is opened or closed nothing else is done")
{
    owner o;
    CHECK(o.step() == act::open);
    CHECK(o.step() == act::open); // not begun yet
    o.policy.begin();
    CHECK(o.step() == act::nothing);
    CHECK_FALSE(o.policy.is_unavailable());
    o.policy.end();
    CHECK(o.step() == act::nothing);
    CHECK_FALSE(o.policy.is_over());
    o.policy.on_open();
    CHECK(o.policy.state() == stream_state::closing);
    o.close();
    CHECK(o.policy.is_over());
}

TEST_CASE("pauses before a lost device is tried again double from 0.1 s to 5 s, for ever")
{
    owner o;
    o.open();
    o.lose();
    CHECK(o.policy.state() == stream_state::lost);
    CHECK(o.policy.reason() == "it is gone");
    for (const double pause_s : {0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0, 5.0}) {
        CHECK(o.policy.needs_proof());
        CHECK(o.wait_for(act::open) == doctest::Approx(pause_s));
        o.fail();
        CHECK(o.policy.reason() == "not there");
    }
    o.now_s += 86400.0;
    CHECK(o.wait_for(act::open));
}

TEST_CASE("a device that opens and then fails is tried less and less often, and is never running")
{
    owner o;
    o.open();
    o.lose();
    for (const double pause_s : {0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0}) {
        CHECK(o.wait_for(act::open) == doctest::Approx(pause_s));
        o.open();
        CHECK(o.step() == act::nothing);
        o.now_s += 0.9;
        CHECK(o.step() == act::nothing);
        CHECK(o.policy.state() == stream_state::lost);
        o.lose();
    }
}

TEST_CASE("a lost device is running when it has held for a second, and the pauses begin anew")
{
    owner o;
    o.open();
    o.lose();
    for (int i = 0; i < 3; ++i) {
        CHECK(o.wait_for(act::open));
        o.fail();
    }
    CHECK(o.wait_for(act::open));
    o.open();
    CHECK(o.step() == act::nothing);
    CHECK(o.policy.next_step_time() == owner::at(o.now_s + 1.0));
    o.now_s += 1.0;
    CHECK(o.step() == act::nothing);
    CHECK(o.policy.state() == stream_state::running);
    CHECK(o.policy.reason().empty());
    o.lose();
    CHECK(o.wait_for(act::open) == doctest::Approx(0.1));
}

TEST_CASE("a device that is not waited for is given up at once")
{
    owner o({.wait_s = 0.0});
    o.open();
    o.lose();
    CHECK_FALSE(o.wait_for(act::open));
    CHECK(o.policy.is_over());
    CHECK(o.policy.is_unavailable());
}

TEST_CASE("a device is waited for as long as is asked for, with a last attempt then; each loss anew")
{
    owner o({.wait_s = 2.0});
    o.open();
    for (int i = 0; i < 2; ++i) {
        o.lose();
        CHECK(o.wait_for(act::open));
        o.open();
        CHECK(o.step() == act::nothing);
        o.now_s += 1.0;
        CHECK(o.step() == act::nothing);
        REQUIRE(o.policy.state() == stream_state::running);
    }
    o.lose();
    const double lost_s = o.now_s;
    std::vector<double> tries_s;
    while (o.wait_for(act::open)) {
        tries_s.push_back(o.now_s - lost_s);
        o.fail();
    }
    REQUIRE(tries_s.size() == 5);
    CHECK(tries_s[3] == doctest::Approx(1.5));
    CHECK(tries_s[4] == doctest::Approx(2.0));
    CHECK(o.policy.is_over());
}

TEST_CASE("while the amplifier may be on the device is never opened again, whoever waits")
{
    for (const bool idle : {false, true}) {
        CAPTURE(idle);
        owner o({.idle_stop_s = 10.0});
        o.open();
        if (idle)
            CHECK(o.wait_for(act::close));
        else
            o.policy.on_end("it is gone");
        o.policy.wake();
        o.close(true);
        CHECK_FALSE(o.wait_for(act::open));
        CHECK(o.policy.is_over());
        CHECK(o.policy.is_unavailable());
        CHECK(o.policy.state() == stream_state::lost);
        CHECK(o.policy.reason().find("the amplifier may be on") != std::string::npos);
    }
}

TEST_CASE("an idle stream closes, and opens for the next stroke without proof")
{
    owner o({.idle_stop_s = 10.0});
    o.open();
    CHECK(o.wait_for(act::close) == doctest::Approx(10.0));
    CHECK(o.policy.state() == stream_state::idle);
    o.close();
    CHECK_FALSE(o.wait_for(act::open));
    CHECK_FALSE(o.policy.is_unavailable());
    o.policy.wake();
    CHECK_FALSE(o.policy.needs_proof());
    o.open();
    CHECK(o.policy.state() == stream_state::running);
}

TEST_CASE("strokes keep a stream from being idle, which begins when the last has ended")
{
    owner o({.idle_stop_s = 10.0});
    o.open();
    CHECK(o.step() == act::nothing);
    o.now_s = 9.0;
    o.policy.set_busy(true);
    CHECK_FALSE(o.wait_for(act::close));
    o.now_s = 100.0;
    o.policy.set_busy(false);
    CHECK(o.wait_for(act::close) == doctest::Approx(10.0));
}

TEST_CASE("only the end of strokes starts the idle time, not the news that there still are none")
{
    owner o({.idle_stop_s = 10.0});
    o.open();
    for (; o.now_s < 10.0; o.now_s += 1.0) {
        CHECK(o.step() == act::nothing);
        o.policy.set_busy(false);
    }
    CHECK(o.step() == act::close);
}

TEST_CASE("a stream that ends because everything was stopped is idle, not lost")
{
    owner o;
    o.open();
    o.policy.on_stop("everything was stopped");
    o.policy.on_end("the stream was stopped");
    CHECK(o.policy.state() == stream_state::idle);
    CHECK(o.policy.reason() == "everything was stopped");
    o.close();
    CHECK_FALSE(o.wait_for(act::open));
    o.policy.wake();
    CHECK_FALSE(o.policy.needs_proof());
    o.open();
    CHECK(o.policy.state() == stream_state::running);
}

TEST_CASE("a stroke that comes while the device is being closed is not forgotten")
{
    owner o({.idle_stop_s = 10.0});
    o.open();
    CHECK(o.wait_for(act::close));
    o.policy.begin();
    CHECK_FALSE(o.policy.is_unavailable());
    o.policy.wake();
    o.policy.on_close(false);
    CHECK(o.step() == act::open);
}

TEST_CASE("a stroke that waits hears of the first attempt that fails")
{
    owner o({.idle_stop_s = 10.0});
    o.open();
    CHECK(o.wait_for(act::close));
    o.close();
    o.policy.wake();
    CHECK(o.step() == act::open);
    o.policy.begin();
    CHECK_FALSE(o.policy.is_unavailable());
    o.policy.on_failure("not there");
    CHECK(o.policy.is_unavailable());
    CHECK(o.wait_for(act::open) == doctest::Approx(0.1));
}

TEST_CASE("a stream is muted only while it runs")
{
    owner o;
    o.policy.mute(true);
    CHECK(o.policy.state() == stream_state::lost);
    o.open();
    o.policy.mute(true);
    CHECK(o.policy.state() == stream_state::muted);
    o.policy.mute(false);
    CHECK(o.policy.state() == stream_state::running);
    CHECK(o.policy.reason().empty());
    o.policy.on_end("it is gone");
    o.policy.mute(true);
    CHECK(o.policy.state() == stream_state::lost);
}

TEST_CASE("after the end nothing is opened, whatever happens")
{
    owner lost;
    lost.open();
    lost.lose();
    lost.policy.end();
    owner runs;
    runs.open();
    runs.policy.end();
    runs.close();
    for (owner* o : {&lost, &runs}) {
        o->policy.wake();
        o->policy.set_busy(true);
        o->now_s += 86400.0;
        CHECK_FALSE(o->wait_for(act::open));
        CHECK(o->policy.is_over());
        CHECK(o->policy.state() == stream_state::closing);
    }
}

TEST_CASE("without an amplifier there is none to be on")
{
    const lent_lines none;
    CHECK(none.lend().amplifier == nullptr);
    CHECK(none.amplifier() == amplifier_state::none);
    CHECK(to_string(none.amplifier()) == "none");
}

TEST_CASE("an amplifier is muted once the player that has it had switched it on")
{
    lent l;
    const player_lines first = l.lines.lend(0.5);
    CHECK(first.proof_s == 0.5);
    CHECK(l.lines.amplifier() == amplifier_state::off);
    CHECK(first.amplifier->set(true));
    CHECK(l.on);
    CHECK(l.lines.amplifier() == amplifier_state::on);
    CHECK(first.amplifier->set(false));
    CHECK(first.amplifier->set(false));
    CHECK(l.lines.amplifier() == amplifier_state::muted);
    CHECK(to_string(l.lines.amplifier()) == "off");
    CHECK(l.switched == 2);
    const player_lines next = l.lines.lend();
    CHECK(l.lines.amplifier() == amplifier_state::off);
}

TEST_CASE("a player that is gone leaves the amplifier off")
{
    lent l;
    CHECK(l.lines.lend().amplifier->set(true));
    CHECK_FALSE(l.on);
    CHECK(l.lines.amplifier() == amplifier_state::muted);
}

TEST_CASE("an amplifier that refuses to go off counts as on, also for the next player")
{
    lent l;
    {
        const player_lines lost = l.lines.lend();
        CHECK(lost.amplifier->set(true));
        l.stuck = true;
        CHECK_FALSE(lost.amplifier->set(false));
    }
    CHECK(l.lines.amplifier() == amplifier_state::on);
    const player_lines next = l.lines.lend();
    CHECK(l.lines.amplifier() == amplifier_state::on);
}

TEST_CASE("counters add up, and the worst value stays the worst")
{
    player_stats sum;
    add_stats(sum, one_of_each(3));
    add_stats(sum, one_of_each(1));
    for (const std::uint64_t n :
         {sum.periods, sum.frames, sum.xruns, sum.limited_frames, sum.power_limited_frames, sum.drives_cut,
          sum.stalls, sum.off_failures, sum.sync_pulses, sum.sync_missed, sum.minor_faults, sum.major_faults})
        CHECK(n == 4);
    CHECK(sum.ring_low_water == 1);
    CHECK(sum.sync_worst_late_s == 3.0);
    CHECK(sum.latest_wakeup_s == 3.0);
    CHECK(sum.sync_mean_late_s == doctest::Approx(2.5)); // of three pulses 3 s, of one 1 s
    CHECK(sum.xrun_s == std::vector<double>{3.0, 1.0});
}

TEST_CASE("one stream without real time makes the sum one without")
{
    player_stats sum;
    add_stats(sum, one_of_each(1));
    CHECK(sum.realtime);
    player_stats without = one_of_each(1);
    without.realtime = false;
    add_stats(sum, without);
    add_stats(sum, one_of_each(1));
    CHECK_FALSE(sum.realtime);
}

TEST_CASE("the newest 64 xruns keep their lengths")
{
    player_stats sum;
    for (int i = 0; i < 100; ++i)
        add_stats(sum, one_of_each(i + 1.0));
    REQUIRE(sum.xrun_s.size() == 64);
    CHECK(sum.xrun_s.front() == 37.0);
    CHECK(sum.xrun_s.back() == 100.0);
}

} // namespace device_stream_test
