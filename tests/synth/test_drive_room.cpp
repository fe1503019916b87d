// SPDX-License-Identifier: MIT
// Room for drives: a piece with room is not cut, and waits no longer than it must.
#include "synth/score/drive_room.hpp"

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/array.hpp>

#include "rounds.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/event_source.hpp"

namespace drive_room_test {

using namespace tactor;

namespace {

constexpr unsigned rate = 8000;

score pieces(const std::vector<burst>& bursts, double level_dbfs)
{
    plan p;
    p.bursts = bursts;
    for (const burst& b : bursts)
        p.total_s = std::max(p.total_s, b.onset_s + b.duration_s);
    p.stroke_duration_s = p.total_s;
    render_options o;
    o.rate = rate;
    o.level_dbfs = level_dbfs;
    return {make_grid("two", 1, 2, 20.0, 20.0), {{.plan = p, .start_s = {}}}, o};
}

burst one(double onset_s, double duration_s, unsigned tactor = 0)
{
    burst b;
    b.onset_s = onset_s;
    b.duration_s = duration_s;
    b.drives = {{.tactor = tactor, .amplitude = 1.0}};
    return b;
}

double wait_s(const synth::drive_room& r, const score& s, double at_s)
{
    const auto frames = r.wait(s, static_cast<std::uint64_t>(at_s * rate));
    return frames ? static_cast<double>(*frames) / rate : -1.0;
}

// Adds a piece to a mixer and plays it to its end.
void play(synth::mixer& m, const score& s)
{
    const std::uint64_t begin = m.position();
    synth::event_source source(s);
    std::vector<float> out(std::size_t{2} * s.frames());
    for (const synth::drive_event* e = source.peek(); e != nullptr; source.pop(), e = source.peek()) {
        synth::drive_event moved = *e;
        moved.start += begin;
        REQUIRE(m.add(moved));
    }
    m.process(s.frames(), reinterpret_cast<std::byte*>(out.data()));
}

void rest(synth::mixer& m, std::uint64_t frames)
{
    std::vector<float> out(2 * frames);
    m.process(frames, reinterpret_cast<std::byte*>(out.data()));
}

} // namespace

TEST_CASE("on a rested array nothing waits; a piece that is too long alone has no room")
{
    const synth::drive_room r(2, {}, rate);
    CHECK(wait_s(r, pieces({one(0.0, 5.0)}, -12.0), 3.0) == 0.0);
    CHECK(wait_s(r, pieces({one(0.0, 5.1)}, -12.0), 3.0) == -1.0);
    CHECK(wait_s(r, pieces({one(0.0, 5.1)}, -47.0), 3.0) == 0.0); // it heats nothing
    CHECK(wait_s(r, pieces({one(0.0, 3.0), one(3.0, 3.0, 1)}, -12.0), 3.0) == 0.0);
    drive_limits none;
    none.max_drive_s = none.window_s;
    CHECK(wait_s(synth::drive_room(2, none, rate), pieces({one(0.0, 500.0)}, -12.0), 0.0) == 0.0);
}

TEST_CASE("a piece waits until the level leaves room for it, counting its own tactors alone")
{
    synth::drive_room r(2, {}, rate);
    r.played(pieces({one(0.0, 4.0)}, -12.0), 0);
    const score three = pieces({one(0.0, 3.0)}, -12.0);
    // It may begin at a level of 2 s.
    CHECK(wait_s(r, three, 4.0) == doctest::Approx(2.0));
    CHECK(wait_s(r, three, 5.0) == doctest::Approx(1.0));
    CHECK(wait_s(r, three, 6.0) == 0.0);
    CHECK(wait_s(r, pieces({one(0.0, 1.0)}, -12.0), 4.0) == 0.0);
    CHECK(wait_s(r, pieces({one(0.0, 3.0, 1)}, -12.0), 4.0) == 0.0);
    // 2 s, a rest of 1 s, 3 s: 4 s more at the end.
    const score parts = pieces({one(0.0, 2.0), one(3.0, 3.0)}, -12.0);
    CHECK(wait_s(r, parts, 4.0) == doctest::Approx(3.0));
    CHECK(wait_s(r, pieces({one(2.0, 2.0)}, -12.0), 4.0) == 0.0); // it rests within the piece
    // A rest within a piece gives back no more than there was.
    r.played(pieces({one(0.0, 0.5), one(9.0, 4.0)}, -12.0), 20 * rate);
    CHECK(wait_s(r, three, 33.0) == doctest::Approx(2.0));
    CHECK(r.rest_s() == 5.0);
    drive_limits short_rest;
    short_rest.max_drive_s = 4.0;
    short_rest.window_s = 5.0; // a second of rest takes 4 s away
    synth::drive_room s(2, short_rest, rate);
    s.played(pieces({one(0.0, 4.0)}, -12.0), 0);
    CHECK(wait_s(s, three, 4.0) == doctest::Approx(0.75).epsilon(1e-3));
}

TEST_CASE("the mixer's guard never changes a piece that has waited as long as computed")
{
    for (int round = 0; round < test::rounds(24); ++round) {
        std::mt19937_64 random(static_cast<std::uint64_t>(round));
        const auto uniform = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        synth::drive_room r(2, {}, rate);
        synth::mixer m(std::vector<double>(2, 1.0), format_kind::float32, 4096, synth::make_guards({}, rate));
        std::uint64_t waited = 0;
        for (int k = 0; k < 20; ++k) {
            std::vector<burst> bursts;
            for (double at = 0.0; at < 2.5; at += uniform(0.03, 0.3))
                bursts.push_back(one(at, uniform(0.02, 0.4), static_cast<unsigned>(random() % 2)));
            const score s = pieces(bursts, uniform(-42.0, -12.0));
            const auto wait = r.wait(s, m.position());
            REQUIRE(wait);
            waited += *wait;
            rest(m, *wait);
            r.played(s, m.position());
            play(m, s);
            rest(m, static_cast<std::uint64_t>(uniform(0.0, 1.0) * rate));
            REQUIRE(m.drives_cut() == 0);
        }
        CHECK(waited < std::uint64_t{20} * 10 * rate);
    }
}

} // namespace drive_room_test
