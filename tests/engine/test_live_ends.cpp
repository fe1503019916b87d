// SPDX-License-Identifier: MIT
// Ends of live strokes, and those that wait for a point or a place.
#include <memory>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "rig.hpp"

namespace live_ends_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Drives the middle tactor at the given amplitude times a factor.
class overdone final : public phantom_model {
public:
    std::string_view name() const noexcept override { return "overdone"; }
    void weights(point, double a_v, std::vector<drive>& out) const override { out = {{4, a_v * factor}}; }

    double factor = 1.0;
};

class failing final : public phantom_model {
public:
    std::string_view name() const noexcept override { return "failing"; }
    void weights(point p, double a_v, std::vector<drive>& out) const override
    {
        out = {{4, a_v}};
        if (p.x_mm > 30.0)
            throw std::runtime_error("its file is gone\nin line 3");
        if (p.x_mm > 20.0)
            throw error(error_kind::runtime, "failing", "it is lost");
        if (p.x_mm > 10.0)
            throw error(error_kind::bad_input, "failing", "not there");
        if (p.y_mm > 10.0)
            throw std::bad_alloc();
        if (p.y_mm > 5.0)
            throw 5;
    }
};

constexpr std::uint64_t timeout_frames = 9600;

const live_options short_timeout{.timeout_s = 0.2};

bool starved(const rig& r, stroke_id id)
{
    return r.report(id) && ending(r.end(id)) == "interrupted, starved: no more points came";
}

} // namespace

TEST_CASE("a live stroke that ends fades, plays its last point, and is reported once as finished")
{
    live_rig r;
    r.live->to({0.0, 0.0}, 1.0);
    const std::uint64_t base = r.status().written;
    r.play(960);
    r.live->to({40.0, 40.0}, 1.0);
    r.live->voice.request(engine::live_voice::action::end);
    CHECK_FALSE(r.live->to({0.0, 40.0}, 1.0));
    const std::uint64_t end = r.status().written + 96 + 480;
    r.play(9600);
    CHECK(r.end({1}).state == state_kind::finished);
    CHECK(r.end({1}).frames == end - base);
    CHECK(peak(r.channel(8)) > 0.7 * live_level);
    CHECK(peak(r.channel(6)) == 0.0);
    CHECK_FALSE(r.first_sound(end));
    CHECK(r.live->voice.closed());
    CHECK_FALSE(r.feed.knows({1}));
}

TEST_CASE("a cancelled live stroke fades, in both renderings and both ways")
{
    for (const bool as_bursts : {false, true}) {
        for (const bool by_handle : {false, true}) {
            live_rig r(as_bursts ? bursts() : live_options{});
            for (int i = 0; i < 35; ++i) {
                r.live->to({0.0, 0.0}, 1.0);
                r.play(96);
            }
            if (by_handle)
                r.live->voice.request(engine::live_voice::action::cancel);
            else
                CHECK(r.feed.cancel({1}));
            const std::uint64_t from = r.status().written;
            r.play(9600);
            CHECK(r.end({1}).state == state_kind::cancelled);
            CHECK_FALSE(r.first_sound(from + 480));
            CHECK(largest_step(r.channel(0)) < live_level * (2 * 3.1416 * 250 / rate + 1.0 / 48));
        }
    }
}

TEST_CASE("a live stroke without new points fades after the time-out and is interrupted with the reason")
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
        CHECK(ending(r.end({1})) == "interrupted, starved: no more points came");
        CHECK(r.first_sound(last + 9000));
        CHECK_FALSE(r.first_sound(last + 9600 + 480 + 3 * 96 + (as_bursts ? 3360 : 0)));
        CHECK_FALSE(r.live->to({0.0, 0.0}, 1.0));
    }
}

TEST_CASE("a live stroke is interrupted after its longest time, to a period, with the reason")
{
    for (const bool as_bursts : {false, true}) {
        live_options o = as_bursts ? bursts() : live_options{};
        o.longest_s = 0.2;
        live_rig r(o);
        r.play(48'000 / 4); // a stroke that waits for its first point does not sound
        CHECK(r.ended.empty());
        r.live->to({0.0, 0.0}, 1.0);
        const std::uint64_t base = r.status().written;
        for (int i = 0; i < 200; ++i) {
            r.live->to({0.0, 0.0}, 1.0);
            r.play(96);
        }
        CHECK(ending(r.end({1})) == "interrupted, too-long: it reached the longest allowed duration");
        CHECK(r.end({1}).frames >= 9600);
        CHECK(r.end({1}).frames <= 9600 + 96 + 480);
        CHECK_FALSE(r.first_sound(base + 9600 + 96 + 480));
        CHECK_FALSE(r.live->to({0.0, 0.0}, 1.0));
    }
}

TEST_CASE("an xrun ends a live stroke that sounds, and spares one that waits for its first point")
{
    live_rig r;
    auto waits = r.add();
    r.live->to({0.0, 0.0}, 1.0);
    r.play(960);
    r.xrun();
    CHECK(ending(r.end({1})) == "interrupted, xrun: xrun: the device ran dry");
    CHECK_FALSE(r.live->to({0.0, 0.0}, 1.0));
    const std::uint64_t from = r.dac.captured_frames();
    CHECK(waits->to({40.0, 40.0}, 1.0));
    r.play(960);
    CHECK(r.first_sound(from));
    CHECK(r.finish(*waits).state == state_kind::finished);
}

TEST_CASE("more live strokes than can sound wait their turn; stop and the device's loss end all")
{
    for (const bool lost : {false, true}) {
        live_rig r;
        const auto all = r.fill(40);
        for (auto& s : all)
            s->to({0.0, 0.0}, 0.01);
        r.play(960);
        CHECK(r.ended.empty());
        for (int i = 0; i < 10; ++i)
            all[static_cast<std::size_t>(i)]->voice.request(engine::live_voice::action::end);
        r.play(9600);
        CHECK(r.ended.size() == 10);
        if (lost)
            r.dac.disconnect();
        else
            r.stop();
        r.play(9600);
        r.step();
        r.control();
        CHECK(r.ended.size() == 40);
        for (const auto& [id, reports] : r.ended) {
            REQUIRE(reports.size() == 1);
            if (id.number > 10)
                CHECK(reports[0].state == (lost ? state_kind::interrupted : state_kind::cancelled));
        }
        for (auto& s : all)
            CHECK_FALSE(s->to({0.0, 0.0}, 1.0));
    }
}

TEST_CASE("a model that exceeds the amplitude it was given interrupts the stroke, faded, with the reason")
{
    for (const bool as_bursts : {false, true}) {
        for (const double smooth_s : {0.0, 0.05}) {
            CAPTURE(as_bursts);
            CAPTURE(smooth_s);
            const auto model = std::make_shared<overdone>();
            live_options o = as_bursts ? bursts() : live_options{};
            o.plan.custom_phantom = model;
            o.smooth_s = smooth_s;
            live_rig r(o);
            for (int i = 0; i < 35; ++i) {
                r.live->to({20.0, 20.0}, 0.5);
                r.play(96);
            }
            model->factor = 1.0 + 1e-10; // a rounding
            CHECK(r.live->to({20.0, 20.0}, 0.5));
            r.play(96);
            model->factor = 1e9;
            CHECK_FALSE(r.live->to({20.0, 20.0}, 0.5));
            CHECK_FALSE(r.live->to({20.0, 20.0}, 0.0));
            const std::uint64_t from = r.status().written;
            r.play(9600);
            CHECK(ending(r.end({1})) == "interrupted, plan: phantom model \"overdone\" gave tactor 4 "
                                        "amplitude 5e+08, above the requested 0.5");
            CHECK_FALSE(r.first_sound(from + 480));
            CHECK(peak(r.channel(4)) <= 0.5 * live_level * (1.0 + 1e-8));
            CHECK(largest_step(r.channel(4)) < live_level * (2 * 3.1416 * 250 / rate + 1.0 / 48));
        }
    }
}

TEST_CASE("a model that exceeds its amplitude ends a stroke before it sounds or while it waits for others")
{
    live_rig r;
    std::vector<std::shared_ptr<live_stroke::impl>> all{r.live};
    const auto model = std::make_shared<overdone>();
    model->factor = 1.001;
    live_options o;
    o.plan.custom_phantom = model;
    o.plan.scale = {.kind = scale_kind::stevens, .exponent = 0.5};
    for (std::size_t i = 0; i < engine::live_places + 3; ++i)
        all.push_back(r.add(o));
    CHECK_FALSE(all[1]->to({20.0, 20.0}, 0.1));
    CHECK_FALSE(all.back()->to({20.0, 20.0}, 0.1));
    r.play(960);
    CHECK(r.ended.size() == 2);
    for (const stroke_id id : {all[1]->id, all.back()->id}) {
        CHECK(r.end(id).frames == 0);
        // The scale maps 0.1 to 0.01.
        CHECK(ending(r.end(id)) == "interrupted, plan: phantom model \"overdone\" gave tactor 4 amplitude "
                                   "0.01001, above the requested 0.01");
    }
    CHECK_FALSE(r.first_sound());
}

TEST_CASE("a model that fails ends the stroke with its message; one that refuses a point does not")
{
    for (const double smooth_s : {0.0, 0.05})
        for (const auto& [at, why] :
             {std::pair{point{35.0, 0.0}, "its file is gone"},
              std::pair{point{25.0, 0.0}, "failing: it is lost"}, std::pair{point{0.0, 7.0}, "it threw"}}) {
            live_options o;
            o.plan.custom_phantom = std::make_shared<failing>();
            o.smooth_s = smooth_s;
            live_rig r(o);
            CHECK(r.live->to({0.0, 0.0}, 1.0));
            r.play(4800);
            CHECK_THROWS_AS(r.live->to({15.0, 0.0}, 1.0), error);
            CHECK_THROWS_AS(r.live->to({0.0, 15.0}, 1.0), std::bad_alloc);
            CHECK(r.live->to({0.0, 0.0}, 1.0));
            r.play(4800);
            CHECK_FALSE(r.report(r.live->id));
            const auto fail = [&, at = at] { r.live->to(at, 1.0); };
            CHECK_THROWS(fail());
            CHECK_FALSE(r.live->to({0.0, 0.0}, 1.0));
            r.play(4800);
            CHECK(ending(r.end(r.live->id)) ==
                  fmt::format("interrupted, plan: phantom model \"failing\" failed: {}", why));
        }
}

TEST_CASE("the time-out holds before the first point, with and without a handle")
{
    live_rig r(short_timeout);
    const stroke_id dropped = r.add(short_timeout)->id;
    const auto patient = r.add(); // 0.5 s
    r.play(timeout_frames - 192);
    CHECK(r.ended.empty());
    r.play(480);
    CHECK(starved(r, r.live->id));
    CHECK(starved(r, dropped));
    CHECK(r.end(dropped).frames == 0);
    CHECK_FALSE(r.live->to({0.0, 0.0}, 1.0));
    CHECK_FALSE(r.report(patient->id));
    CHECK(patient->to({0.0, 0.0}, 1.0));
    r.play(960);
    CHECK(r.first_sound());
}

TEST_CASE("live strokes beyond the places wait in order, with their newest point, and time out without one")
{
    live_rig r;
    const auto most = static_cast<std::size_t>(engine::live_voices);
    const auto all = r.fill(most);
    const auto feed = [&](std::uint64_t frames) {
        for (std::uint64_t f = 0; f < frames; f += 480) {
            for (std::size_t i = 0; i < most; ++i)
                all[i]->to({40.0, 40.0}, 0.01);
            r.play(480);
        }
    };
    feed(480);
    const auto silent = r.add(short_timeout);
    silent->to({0.0, 0.0}, 1.0); // its only point
    const auto ended = r.add(short_timeout);
    ended->to({0.0, 0.0}, 1.0);
    ended->to({20.0, 0.0}, 1.0);
    ended->voice.request(engine::live_voice::action::end); // no more points are due
    const auto last = r.add();
    feed(timeout_frames + 960);
    CHECK(starved(r, silent->id));
    CHECK_FALSE(r.report(ended->id));
    CHECK(peak(r.channel(0)) == 0.0);
    CHECK(peak(r.channel(1)) == 0.0);

    last->to({0.0, 40.0}, 1.0);
    all[3]->voice.request(engine::live_voice::action::end); // one place, for the first that waits
    feed(3360);
    CHECK(r.end(ended->id).state == state_kind::finished);
    CHECK(r.end(ended->id).frames > 0);
    CHECK(peak(r.channel(1)) > 0.5 * live_level);
    feed(960);
    CHECK(peak(r.channel(6)) > 0.5 * live_level);
}

TEST_CASE(
    "hundreds of live strokes without a point: each is cancelled, ended or timed out, wherever it waits")
{
    live_rig r(short_timeout);
    const auto all = r.fill(3 * engine::live_places, short_timeout);
    r.play(960);
    CHECK(r.ended.empty());
    for (std::size_t i = 0; i < all.size(); ++i)
        if (i % 3 == 1)
            all[i]->voice.request(engine::live_voice::action::end);
        else if (i % 6 == 2)
            all[i]->voice.request(engine::live_voice::action::cancel);
        else if (i % 6 == 5)
            CHECK(r.feed.cancel(all[i]->id));
    r.play(288);
    CHECK(r.ended.size() == 2 * engine::live_places);
    r.play(timeout_frames);
    CHECK(r.ended.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto report = r.end(all[i]->id);
        CHECK(report.frames == 0);
        CHECK(report.state == (i % 3 == 0   ? state_kind::interrupted
                               : i % 3 == 1 ? state_kind::finished
                                            : state_kind::cancelled));
        CHECK(all[i]->voice.closed());
        CHECK_FALSE(all[i]->to({0.0, 0.0}, 1.0));
    }
    const auto fresh = r.add();
    fresh->to({0.0, 0.0}, 1.0);
    r.play(960);
    CHECK(r.first_sound());
}

} // namespace live_ends_test
