// SPDX-License-Identifier: MIT
// Live strokes without points, handles or a place: none waits for ever or keeps others waiting.
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include "live_rig.hpp"

namespace waiting_live_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr std::uint64_t timeout_frames = 9600;

live_options short_timeout()
{
    live_options o;
    o.timeout_s = 0.2;
    return o;
}

bool starved(const rig& r, stroke_id id)
{
    return r.report(id) && r.report(id)->state == state_kind::interrupted &&
           r.end(id).why == "no more points came";
}

} // namespace

TEST_CASE("live strokes without points take no place from those with points")
{
    live_rig r;
    std::vector<std::shared_ptr<live_stroke::impl>> unfed;
    for (int i = 0; i < 60; ++i)
        unfed.push_back(r.add());
    const auto fed = r.add();
    fed->to({0.0, 0.0}, 1.0);
    const std::uint64_t next = r.status().written;
    r.play(960);
    const auto sound = r.first_sound();
    REQUIRE(sound);
    CHECK(*sound <= next + 2);
}

TEST_CASE("the time-out holds before the first point, with and without a handle")
{
    live_rig r(short_timeout());
    const stroke_id dropped = r.add(short_timeout())->id;
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
    const auto silent = r.add(short_timeout());
    silent->to({0.0, 0.0}, 1.0); // its only point
    const auto ended = r.add(short_timeout());
    ended->to({0.0, 0.0}, 1.0);
    ended->to({20.0, 0.0}, 1.0);
    ended->voice.request(engine::live_voice::action::end); // no more points are due
    const auto last = r.add();
    feed(timeout_frames + 960);
    CHECK(starved(r, silent->id));
    CHECK_FALSE(r.report(ended->id));
    CHECK(peak(r.channel(0), 0, SIZE_MAX) == 0.0);
    CHECK(peak(r.channel(1), 0, SIZE_MAX) == 0.0);

    last->to({0.0, 40.0}, 1.0);
    all[3]->voice.request(engine::live_voice::action::end); // one place, for the first that waits
    feed(3360);
    CHECK(r.end(ended->id).state == state_kind::finished);
    CHECK(r.end(ended->id).frames > 0);
    CHECK(peak(r.channel(1), 0, SIZE_MAX) > 0.5 * live_level);
    feed(960);
    CHECK(peak(r.channel(6), 0, SIZE_MAX) > 0.5 * live_level);
}

TEST_CASE("hundreds of live strokes at once: each can be cancelled, ended or timed out, wherever it waits")
{
    live_rig r(short_timeout());
    const auto all = r.fill(3 * engine::live_places, short_timeout());
    r.play(960);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (i % 3 == 1)
            all[i]->voice.request(engine::live_voice::action::end);
        else if (i % 3 == 2)
            all[i]->voice.request(engine::live_voice::action::cancel);
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
    }
    const auto fresh = r.add();
    fresh->to({0.0, 0.0}, 1.0);
    r.play(960);
    CHECK(r.first_sound());
}

TEST_CASE("a live stroke that waits for a place is cancelled by its number, once")
{
    live_rig r;
    const auto all = r.fill(engine::live_places + 1);
    const auto& last = all.back();
    CHECK(r.feed.knows(last->id));
    CHECK(r.feed.cancel(last->id));
    CHECK_FALSE(r.feed.cancel(last->id));
    CHECK(last->voice.closed());
    r.control();
    CHECK(r.end(last->id).state == state_kind::cancelled);
    CHECK_FALSE(r.feed.knows(last->id));
}

} // namespace waiting_live_test
