// SPDX-License-Identifier: MIT
// Strokes that are fed point by point, on the virtual clock.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "count_allocations.hpp"
#include "engine/live_stroke.hpp"
#include "rig.hpp"

using namespace tactor;
using namespace tactor::test;

namespace {

const double level = std::pow(10.0, -12.0 / 20.0);

// A rig with one live stroke.
class live_rig : public rig {
public:
    explicit live_rig(const live_options& o = {}, const rig_options& r = {}) : rig(r)
    {
        REQUIRE(start().status == io_status::ok);
        live = add(o);
    }

    std::shared_ptr<live_stroke::impl> add(const live_options& o = {})
    {
        const array a = palm();
        auto s = std::make_shared<live_stroke::impl>(++last_id, a, layout(a), out->setup(), o);
        feed.submit(last_id, std::shared_ptr<engine::live_voice>(s, &s->voice));
        feed.pump(status().written, link.clock.load());
        return s;
    }

    std::vector<double> channel(unsigned c, std::uint64_t from = 0) const
    {
        const std::vector<std::byte> all = dac.captured(from);
        std::vector<double> samples;
        for (std::size_t f = 0; f < all.size() / dac.frame_bytes(); ++f) {
            std::int32_t v = 0;
            std::memcpy(&v, &all[f * dac.frame_bytes() + 4 * c], 4);
            samples.push_back(v / 2147483648.0);
        }
        return samples;
    }

    std::shared_ptr<live_stroke::impl> live;
};

double peak(const std::vector<double>& s, std::size_t from, std::size_t to)
{
    double most = 0.0;
    for (std::size_t i = from; i < std::min(to, s.size()); ++i)
        most = std::max(most, std::abs(s[i]));
    return most;
}

double largest_step(const std::vector<double>& s)
{
    double most = 0.0;
    for (std::size_t i = 1; i < s.size(); ++i)
        most = std::max(most, std::abs(s[i] - s[i - 1]));
    return most;
}

live_options bursts()
{
    live_options o;
    o.plan.method = algorithm::park2016;
    return o;
}

} // namespace

TEST_CASE("silent until the first point, then a sine at its tactor, from the next period on")
{
    live_rig r;
    r.play(4800);
    CHECK_FALSE(r.first_sound());
    CHECK_FALSE(r.status().sounding);
    CHECK(r.live->to({0.0, 0.0}, 1.0));
    const std::uint64_t next = r.status().written;
    r.play(9600);
    CHECK(r.status().stroke == r.last_id);
    const auto sound = r.first_sound();
    REQUIRE(sound);
    CHECK(*sound <= next + 2);
    CHECK(*sound >= next);
    const auto s = r.channel(0, next);
    for (std::size_t i = 48; i < 9600; ++i)
        REQUIRE(s[i] ==
                doctest::Approx(level * std::sin(2 * 3.14159265358979 * 250 * static_cast<double>(i) / rate))
                    .epsilon(1e-6)
                    .scale(0.1));
    for (unsigned c = 1; c < 9; ++c)
        CHECK(peak(r.channel(c), 0, SIZE_MAX) == 0.0);
}

TEST_CASE("a point is heard within a period and a control step, in every phase and size of period")
{
    for (const unsigned period : {16U, 48U, 96U, 480U, 1024U}) {
        CAPTURE(period);
        live_rig r({}, {.period = period});
        r.live->to({0.0, 0.0}, 1.0);
        r.play(period * 20);
        for (int i = 0; i < 20; ++i) {
            const bool here = i % 2 != 0;
            const std::uint64_t next = r.status().written;
            r.live->to({here ? 0.0 : 40.0, here ? 0.0 : 40.0}, 1.0);
            const unsigned channel = here ? 0 : 8;
            for (unsigned n = 0; n * period < 480 + 3 * period; ++n)
                r.play(period);
            const auto s = r.channel(channel, next);
            std::size_t first = 0;
            while (first < s.size() && s[first] == 0.0)
                ++first;
            CHECK(first <= period + 48 + 2);
            CHECK(peak(s, std::max(period, 48U) + 48, SIZE_MAX) > 0.5 * level);
        }
    }
}

TEST_CASE("wherever the points jump, the samples do not")
{
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> place(0.0, 40.0);
    for (const unsigned period : {16U, 96U, 480U}) {
        live_rig r({}, {.period = period});
        for (int i = 0; i < 2000; ++i) {
            r.live->to({place(random), place(random)}, static_cast<double>(random() % 2));
            r.play(period);
        }
        r.live->voice.ask(engine::live_voice::wish::end);
        r.play_out();
        // The carrier's slope and a whole amplitude within a control step.
        const double allowed = level * (2 * 3.1416 * 250 / rate + 1.0 / 48);
        for (unsigned c = 0; c < 9; ++c)
            CHECK(largest_step(r.channel(c)) < allowed);
        CHECK(r.report(1)->state == stroke_state::finished);
    }
}

TEST_CASE("end fades out, plays the last point given, and is reported once as finished")
{
    live_rig r;
    r.live->to({0.0, 0.0}, 1.0);
    const std::uint64_t base = r.status().written;
    r.play(960);
    r.live->to({40.0, 40.0}, 1.0);
    r.live->voice.ask(engine::live_voice::wish::end);
    CHECK_FALSE(r.live->to({0.0, 40.0}, 1.0));
    const std::uint64_t end = r.status().written + 96 + 480;
    r.play(9600);
    REQUIRE(r.report(1));
    CHECK(r.report(1)->state == stroke_state::finished);
    CHECK(r.report(1)->frames == end - base);
    CHECK(peak(r.channel(8), 0, SIZE_MAX) > 0.7 * level);
    CHECK(peak(r.channel(6), 0, SIZE_MAX) == 0.0);
    CHECK_FALSE(r.first_sound(end));
    CHECK(r.live->voice.closed());
    CHECK_FALSE(r.feed.knows(1));
}

TEST_CASE("a live stroke without a point: ended it is finished with nothing, and cancelled it is cancelled")
{
    live_rig r;
    auto other = r.add();
    auto third = r.add();
    r.play(960);
    CHECK(r.ended.empty());
    r.live->voice.ask(engine::live_voice::wish::end);
    other->voice.ask(engine::live_voice::wish::cancel);
    CHECK(r.feed.cancel(3));
    r.play(960);
    CHECK(r.report(1)->state == stroke_state::finished);
    CHECK(r.report(2)->state == stroke_state::cancelled);
    CHECK(r.report(3)->state == stroke_state::cancelled);
    for (stroke_id id : {1U, 2U, 3U})
        CHECK(r.report(id)->frames == 0);
    CHECK_FALSE(third->to({0, 0}, 1.0));
}

TEST_CASE("cancel fades, in both renderings and both ways")
{
    for (const bool as_bursts : {false, true}) {
        for (const bool by_handle : {false, true}) {
            live_rig r(as_bursts ? bursts() : live_options{});
            for (int i = 0; i < 35; ++i) {
                r.live->to({0.0, 0.0}, 1.0);
                r.play(96);
            }
            if (by_handle)
                r.live->voice.ask(engine::live_voice::wish::cancel);
            else
                CHECK(r.feed.cancel(1));
            const std::uint64_t from = r.status().written;
            r.play(9600);
            REQUIRE(r.report(1));
            CHECK(r.report(1)->state == stroke_state::cancelled);
            CHECK_FALSE(r.first_sound(from + 480));
            CHECK(largest_step(r.channel(0)) < level * (2 * 3.1416 * 250 / rate + 1.0 / 48));
        }
    }
}

TEST_CASE("a producer that falls silent: faded out after the time-out, interrupted, with the reason")
{
    for (const bool as_bursts : {false, true}) {
        live_options o = as_bursts ? bursts() : live_options{};
        o.timeout_s = 0.2;
        live_rig r(o);
        for (int i = 0; i < 200; ++i) { // points that stand still are points
            r.live->to({0.0, 0.0}, 1.0);
            r.play(96);
            REQUIRE(r.ended.empty());
        }
        const std::uint64_t last = r.status().written;
        r.play(48'000);
        REQUIRE(r.report(1));
        CHECK(r.report(1)->state == stroke_state::interrupted);
        CHECK(r.report(1)->reason == "no more points came");
        CHECK(r.first_sound(last + 9000));
        CHECK_FALSE(r.first_sound(last + 9600 + 480 + 3 * 96 + (as_bursts ? 3360 : 0)));
        CHECK_FALSE(r.live->to({0.0, 0.0}, 1.0));
    }
}

TEST_CASE("bursts: each SOA one, at the newest position, as long as the law says")
{
    live_options o = bursts();
    o.plan.soa_s = 0.06;
    live_rig r(o);
    r.live->to({0.0, 0.0}, 1.0);
    const std::uint64_t base = r.status().written;
    for (std::uint64_t f = 0; f < 20 * 2880; f += 96) {
        const auto n = (f + 96) / 2880; // of the next burst
        r.live->to({20.0 * static_cast<double>(n % 3), 0.0}, 1.0);
        r.play(96);
    }
    const auto duration = static_cast<std::size_t>(std::lround(burst_duration_s({}, 0.06) * rate));
    for (unsigned c = 0; c < 3; ++c) {
        const auto s = r.channel(c, base);
        for (std::size_t k = 0; k < 19; ++k) {
            CAPTURE(k);
            CAPTURE(c);
            const std::size_t at = k * 2880;
            CHECK((peak(s, at, at + duration) > 0.9 * level) == (k % 3 == c));
            CHECK(peak(s, at + duration, at + 2880) == 0.0);
        }
    }
    r.live->voice.ask(engine::live_voice::wish::end);
    r.play_out();
    CHECK(r.report(1)->state == stroke_state::finished);
    CHECK(r.report(1)->frames % 2880 == duration);
}

TEST_CASE("outside the array the nearest point plays, and is counted; or it is an error")
{
    live_rig r;
    CHECK(r.live->to({-50.0, 0.0}, 1.0));
    CHECK(r.live->to({10.0, 10.0}, 1.0));
    CHECK(r.live->to({1e300, -1e300}, 1.0));
    CHECK(r.live->points == 3);
    CHECK(r.live->outside_points == 2);
    live_options strict;
    strict.plan.leave = outside::error;
    auto s = r.add(strict);
    CHECK_THROWS_AS(s->to({-50.0, 0.0}, 1.0), error);
    CHECK(s->to({0.0, 0.0}, 1.0));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, inf, -inf}) {
        CHECK_THROWS_AS(r.live->to({bad, 0.0}, 1.0), error);
        CHECK_THROWS_AS(r.live->to({0.0, bad}, 1.0), error);
        CHECK_THROWS_AS(r.live->to({0.0, 0.0}, bad), error);
    }
    CHECK_THROWS_AS(r.live->to({0.0, 0.0}, -0.1), error);
    CHECK(r.live->to({0.0, 0.0}, 1e300)); // held at the channel's limit
    CHECK(r.live->limited_points == 1);
    r.play(9600);
    CHECK(peak(r.channel(0), 0, SIZE_MAX) <= 1.0);
}

TEST_CASE("options that cannot be are errors")
{
    live_rig r;
    const auto refused = [&](auto change) {
        live_options o = bursts();
        change(o);
        CHECK_THROWS_AS(r.add(o), error);
        --r.last_id;
    };
    refused([](live_options& o) { o.plan.method = algorithm::tactile_brush; });
    refused([](live_options& o) { o.plan.carrier_hz = 24000.0; });
    refused([](live_options& o) { o.plan.carrier_hz = std::nan(""); });
    refused([](live_options& o) { o.plan.soa_s = 0.2; });
    refused([](live_options& o) { o.timeout_s = 0.0; });
    refused([](live_options& o) { o.timeout_s = std::nan(""); });
    refused([](live_options& o) { o.render.level_dbfs = 3.0; });
    refused([](live_options& o) { o.render.sl_db = 7.0; });
    refused([](live_options& o) { o.render.ramp_s = -1.0; });
    refused([](live_options& o) {
        o.plan.profile.intercept_s = 0.0;
        o.plan.soa_s = 0.001;
    });
}

TEST_CASE("an xrun ends a live stroke that sounds, and leaves one alone that waits for its first point")
{
    live_rig r;
    auto waits = r.add();
    r.live->to({0.0, 0.0}, 1.0);
    r.play(960);
    r.dac.advance(10'000);
    r.step();
    r.control();
    REQUIRE(r.report(1));
    CHECK(r.report(1)->state == stroke_state::interrupted);
    CHECK(r.report(1)->reason == "xrun: the device ran dry");
    CHECK_FALSE(r.live->to({0.0, 0.0}, 1.0));
    const std::uint64_t from = r.dac.captured_frames();
    CHECK(waits->to({40.0, 40.0}, 1.0));
    r.play(960);
    CHECK(r.first_sound(from));
    waits->voice.ask(engine::live_voice::wish::end);
    r.play_out();
    CHECK(r.report(2)->state == stroke_state::finished);
}

TEST_CASE("more live strokes than can sound at once wait their turn; stop and the device's loss end all")
{
    for (const bool lost : {false, true}) {
        live_rig r;
        std::vector<std::shared_ptr<live_stroke::impl>> all{r.live};
        for (int i = 0; i < 39; ++i)
            all.push_back(r.add());
        for (auto& s : all)
            s->to({0.0, 0.0}, 0.01);
        r.play(960);
        CHECK(r.ended.empty());
        for (int i = 0; i < 10; ++i)
            all[static_cast<std::size_t>(i)]->voice.ask(engine::live_voice::wish::end);
        r.play(9600);
        CHECK(r.ended.size() == 10);
        if (lost)
            r.dac.disconnect();
        else
            r.link.requests.push({.what = engine::request::kind::stop});
        r.play(9600);
        r.step();
        r.control();
        CHECK(r.ended.size() == 40);
        for (const auto& [id, reports] : r.ended) {
            REQUIRE(reports.size() == 1);
            if (id > 10)
                CHECK(reports[0].state == (lost ? stroke_state::interrupted : stroke_state::cancelled));
        }
        for (auto& s : all)
            CHECK_FALSE(s->to({0.0, 0.0}, 1.0));
    }
}

TEST_CASE("an hour of a live stroke: no heap in the audio thread, nothing grows")
{
    if (!counts_allocations())
        return;
    live_rig r({}, {.period = 960});
    r.dac.reserve_capture(1 << 16);
    for (int i = 0; i < 100; ++i) {
        r.live->to({20.0, 1.0 * (i % 40)}, 1.0);
        r.play(960);
    }
    std::uint64_t calls = 0;
    std::int64_t held = 0; // by the producer, whose phantom model may use the heap
    for (int i = 0; i < 180'000; ++i) {
        {
            const count_allocations count;
            r.live->to({20.0 + 20.0 * std::sin(0.01 * i), 20.0 + 20.0 * std::cos(0.013 * i)}, 1.0);
            held += count.bytes();
        }
        r.dac.advance_queued(960);
        {
            const count_allocations count;
            r.step();
            calls += count.calls();
        }
        r.control();
        REQUIRE(r.ended.empty());
    }
    CHECK(calls == 0);
    CHECK(held == 0);
    r.live->voice.ask(engine::live_voice::wish::end);
    r.play_out();
    CHECK(r.report(1)->state == stroke_state::finished);
    CHECK(r.report(1)->frames > 3600ULL * rate);
}
