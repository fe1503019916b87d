// SPDX-License-Identifier: MIT
// The limit of how long a tactor is driven, and the room that it leaves.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/array.hpp>

#include "pieces.hpp"
#include "rounds.hpp"
#include "synth/limits/guard.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/drive_room.hpp"
#include "synth/score/event_source.hpp"

namespace drive_time_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 8000;
constexpr std::size_t cycle = rate / 250;
constexpr std::size_t fade = rate / 50;

synth::drive_event voice(double start_s, double length_s, double from, double to, double cycles = 0.0)
{
    synth::drive_event e =
        make_event(static_cast<std::uint64_t>(std::llround(start_s * rate)),
                   static_cast<std::uint32_t>(std::llround(length_s * rate)), 250.0 / rate, {from, to, 0});
    e.phase_frame = static_cast<std::uint64_t>(std::llround(cycles * cycle));
    return e;
}

synth::drive_event voice(double start_s, double length_s, double amplitude)
{
    return voice(start_s, length_s, amplitude, amplitude);
}

struct played {
    std::vector<float> x;
    std::uint64_t cuts = 0;
};

synth::guard_settings limit_time(double max_drive_s, double window_s)
{
    return synth::make_guards({.max_drive_s = max_drive_s, .window_s = window_s}, rate);
}

played play(const std::vector<synth::drive_event>& events, double total_s, const synth::guard_settings& g,
            double limit = 1.0, std::size_t block = 4096)
{
    synth::mixer m(std::vector<double>(1, limit), format_kind::float32, events.size(), g);
    for (const synth::drive_event& e : events)
        REQUIRE(m.add(e));
    played p;
    p.x.resize(static_cast<std::size_t>(total_s * rate));
    for (std::size_t done = 0; done < p.x.size(); done += block)
        m.process(std::min(block, p.x.size() - done), reinterpret_cast<std::byte*>(p.x.data() + done));
    p.cuts = m.counts().drives_cut;
    return p;
}

/// Counts frames in which a channel is driven: above -40 dBFS, and between two such frames half a cycle
/// apart.
std::vector<unsigned> driven(const std::vector<float>& x)
{
    std::vector<unsigned> d(x.size());
    std::size_t last = x.size();
    for (std::size_t k = 0; k < x.size(); ++k) {
        if (std::abs(x[k]) > 0.01F) {
            std::fill(d.begin() + static_cast<std::ptrdiff_t>(k - last < cycle / 2 ? last : k),
                      d.begin() + static_cast<std::ptrdiff_t>(k + 1), 1U);
            last = k;
        }
    }
    return d;
}

std::size_t most_in_a_window(const std::vector<float>& x, std::size_t window)
{
    const std::vector<unsigned> d = driven(x);
    std::size_t sum = 0;
    std::size_t most = 0;
    for (std::size_t k = 0; k < d.size(); ++k) {
        sum += d[k];
        sum -= k >= window ? d[k - window] : 0;
        most = std::max(most, sum);
    }
    return most;
}

/// Returns the time of the last sound before the first silence of 50 ms.
double end_s(const std::vector<float>& x)
{
    std::size_t last = 0;
    for (std::size_t k = 0; k < x.size() && k < last + rate / 20; ++k)
        last = x[k] != 0.0F ? k : last;
    return static_cast<double>(last) / rate;
}

double decibels(double db)
{
    return std::pow(10.0, db / 20.0);
}

score piece(std::vector<burst> bursts, double level_dbfs)
{
    return {row(2), make_plan(std::move(bursts)), {.rate = rate, .level_dbfs = level_dbfs}};
}

burst one(double onset_s, double duration_s, unsigned tactor = 0)
{
    return make_burst(onset_s, duration_s, {{tactor, 1.0}});
}

double wait_s(const synth::drive_room& r, const score& s, double at_s)
{
    const auto frames = r.wait(s, static_cast<std::uint64_t>(at_s * rate));
    return frames ? static_cast<double>(*frames) / rate : -1.0;
}

void rest(synth::mixer& m, std::uint64_t frames)
{
    std::vector<float> out(2 * frames);
    m.process(frames, reinterpret_cast<std::byte*>(out.data()));
}

// Adds a piece to a mixer and plays it to its end.
void play(synth::mixer& m, const score& s)
{
    const std::uint64_t begin = m.position();
    synth::event_source source(s);
    for (const synth::drive_event* e = source.peek(); e != nullptr; source.pop(), e = source.peek()) {
        synth::drive_event moved = *e;
        moved.start += begin;
        REQUIRE(m.add(moved));
    }
    rest(m, s.frames());
}

} // namespace

TEST_CASE("many weak strokes on one tactor are cut where a strong one is")
{
    const synth::guard_settings g = limit_time(5.0, 10.0);
    const played strong = play({voice(0.0, 20.0, decibels(-0.1))}, 20.0, g);
    const played weak =
        play(std::vector<synth::drive_event>(100, voice(0.0, 20.0, decibels(-40.1))), 20.0, g);
    CHECK(strong.cuts == weak.cuts);
    CHECK(strong.cuts >= 3);
    CHECK(end_s(strong.x) == doctest::Approx(5.02).epsilon(1e-3));
    CHECK(end_s(weak.x) == doctest::Approx(5.02).epsilon(1e-3));
}

TEST_CASE(
    "strokes that cancel each other, and strokes held below -40 dBFS by the tactor's limit, do not count")
{
    const synth::guard_settings g = limit_time(0.5, 1.0);
    const std::vector<synth::drive_event> opposite{voice(0.0, 3.0, 0.5, 0.5), voice(0.0, 3.0, 0.5, 0.5, 0.5)};
    CHECK(play(opposite, 3.0, g).cuts == 0);
    CHECK(play({voice(0.0, 3.0, 0.5), voice(0.0, 3.0, 0.5)}, 3.0, g).cuts > 0);
    CHECK(play({voice(0.0, 3.0, 0.5), voice(0.0, 3.0, 0.5)}, 3.0, g, 0.0099).cuts == 0);
}

TEST_CASE("only the part of a stroke above -40 dBFS counts")
{
    // From 0 to 0.02 in 1 s: the second half of it.
    const std::vector<synth::drive_event> rising{voice(0.0, 1.0, 0.0, 0.02)};
    CHECK(play(rising, 1.1, limit_time(0.51, 2.0)).cuts == 0);
    CHECK(play(rising, 1.1, limit_time(0.49, 2.0)).cuts == 1);
    synth::drive_event window = voice(0.0, 1.0, 0.02); // as much of it: 0.5 s above
    window.ramp = rate / 2;
    CHECK(play({window}, 1.1, limit_time(0.51, 2.0)).cuts == 0);
    CHECK(play({window}, 1.1, limit_time(0.49, 2.0)).cuts == 1);
}

TEST_CASE(
    "no tactor is driven for longer than the limit without a rest, nor in any window for longer than twice "
    "its share, for any mix")
{
    std::mt19937_64 random(29);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    // Steps of a cycle, so that gaps differ from zero crossings.
    const auto whole = [](double s) { return std::round(s * 250.0) / 250.0; };
    unsigned cut = 0;
    for (int run = 0; run < tactor::test::rounds(60); ++run) {
        const double limit_s = 0.1 + 0.9 * unit(random) * unit(random);
        const double window_s = limit_s * (1.02 + 14.0 * unit(random));
        std::vector<synth::drive_event> events;
        const double shortest = run % 3 == 0 ? 0.004 : 0.05;
        for (double t = 0.0; t < 12.0; t += whole(0.3 * limit_s * unit(random) * unit(random))) {
            const double from = 0.15 * unit(random);
            const double to = run % 2 == 0 ? from : 0.15 * unit(random);
            events.push_back(voice(t, shortest + whole(limit_s * unit(random) * unit(random)), from, to,
                                   run % 5 == 0 ? 0.0 : unit(random)));
            events.back().ramp = run % 4 == 0 ? 8 : 0;
            t += run % 7 == 0 ? whole(window_s * unit(random)) : 0.004;
        }
        const played p = play(events, 14.0, limit_time(limit_s, window_s));
        CAPTURE(run);
        CAPTURE(limit_s);
        CAPTURE(window_s);
        const double leak = limit_s / (window_s - limit_s);
        const double limit = limit_s * rate;
        const auto window = static_cast<std::size_t>(std::llround(window_s * rate));
        const std::vector<unsigned> d = driven(p.x);
        // The level, independently: a fade is above it by 20 ms, and so much more each time it opens.
        double level = 0.0;
        double most = 0.0;
        std::size_t in_a_row = 0;
        std::size_t longest = 0;
        for (const unsigned one : d) {
            level = one != 0 ? level + 1.0 : std::max(level - leak, 0.0);
            most = std::max(most, level);
            in_a_row = one != 0 ? in_a_row + 1 : 0;
            longest = std::max(longest, in_a_row);
        }
        CHECK(most <= limit + 2.0 * fade);
        CHECK(static_cast<double>(longest) <= limit + fade + leak * cycle); // short rests leak, too
        const double fades = fade * (1.0 + 2.0 * static_cast<double>(window) / limit);
        CHECK(static_cast<double>(most_in_a_window(p.x, window)) <=
              limit * (2.0 - limit_s / window_s) + fades);
        cut += p.cuts > 0 ? 1 : 0;
        if (p.cuts > 0)
            CHECK(most >= limit - fade); // and no earlier than needed
    }
    CHECK(cut > tactor::test::rounds(60) / 6);
}

TEST_CASE("a pattern that is within the limit to the frame is unchanged")
{
    for (const double part : {5.0, 0.5, 0.1, 0.04}) {
        std::vector<synth::drive_event> events;
        for (double t = 0.0; t < 40.0; t += 2.0 * part)
            events.push_back(voice(t, part, 0.7));
        CAPTURE(part);
        CHECK(play(events, 41.0, limit_time(5.0, 10.0)).cuts == 0);
        CHECK(play(events, 41.0, limit_time(5.0, 10.0)).x == play(events, 41.0, {}).x);
    }
    CHECK(play({voice(0.0, 5.0, 0.7)}, 6.0, limit_time(5.0 - 4.0 / rate, 10.0)).cuts == 1);
}

TEST_CASE(
    "in the long run a tactor is driven for the limit of each window, and rests in between until half of it")
{
    const synth::guard_settings g = limit_time(0.5, 2.0); // a second of rest takes a third of a second away
    const played p = play({voice(0.0, 60.0, 0.5)}, 60.0, g);
    const std::vector<unsigned> d = driven(p.x);
    const double part =
        static_cast<double>(std::count(d.begin(), d.end(), 1U)) / static_cast<double>(d.size());
    CHECK(part == doctest::Approx(0.25).epsilon(0.05));
    // It is closed at 0.5 s, faded out at 0.52, and open at 0.52 + 0.27 * 3 s.
    CHECK(end_s(p.x) == doctest::Approx(0.52).epsilon(2e-3));
    const auto sounds = [&](double from_s, double to_s) {
        return std::any_of(p.x.begin() + static_cast<std::ptrdiff_t>(from_s * rate),
                           p.x.begin() + static_cast<std::ptrdiff_t>(to_s * rate),
                           [](float v) { return v != 0.0F; });
    };
    CHECK_FALSE(sounds(0.521, 1.329));
    CHECK(sounds(1.331, 1.34));
}

TEST_CASE("a quiet stroke on a channel that was cut is silent too, for any block size")
{
    const std::vector<synth::drive_event> events{voice(0.0, 1.5, 0.5), voice(0.1, 2.9, 0.003),
                                                 voice(2.4, 0.2, 0.008, 0.012)};
    const synth::guard_settings g = limit_time(0.5, 2.0);
    const played whole = play(events, 3.0, g);
    CHECK(std::all_of(whole.x.begin() + rate * 6 / 10, whole.x.begin() + rate * 13 / 10,
                      [](float v) { return v == 0; }));
    for (const std::size_t block : {1, 7, 160, 161, 500})
        CHECK(play(events, 3.0, g, 1.0, block).x == whole.x);
}

TEST_CASE("each drive that meets a closed channel counts, even a quiet one, for any block size")
{
    const synth::guard_settings g = limit_time(0.5, 2.0);
    const auto cuts = [&](std::vector<synth::drive_event> more, std::size_t block = 160) {
        more.insert(more.begin(), voice(0.0, 0.7, 0.5)); // closed from 0.5 s on, until 1.33 s
        return play(more, 3.0, g, 1.0, block).cuts;
    };
    CHECK(cuts({}) == 1);
    CHECK(cuts({voice(0.9, 0.1, 0.5)}) == 2);
    CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.2, 0.1, 0.003)}) == 3);
    CHECK(cuts({voice(2.5, 0.1, 0.5)}) == 1);                       // open again
    CHECK(cuts({voice(1.32, 0.2, 0.5)}) == 2);                      // faded in
    CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.0, 0.1, 0.5)}) == 2); // without a gap it is one
    CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.01, 0.1, 0.5)}) == 3);
    for (const std::size_t block : {1, 7, 161, 500})
        CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.2, 0.1, 0.003)}, block) == 3);
    // Its last sample is the last allowed one: nothing changes.
    CHECK(play({voice(0.0, 0.5, 0.5)}, 1.0, g).cuts == 0);
}

TEST_CASE("the next mixer begins with the levels that it is given, at another rate")
{
    const auto cut_s = [](const std::vector<double>& levels_s) {
        constexpr unsigned other = 48000;
        drive_limits l{.max_drive_s = 0.5, .window_s = 1.0};
        synth::mixer m(std::vector<double>(2, 1.0), format_kind::float32, 8, synth::make_guards(l, other));
        for (std::size_t c = 0; c < levels_s.size(); ++c)
            m.raise(c, levels_s[c]);
        synth::drive_event e = make_event(0, other, 250.0 / other, {0.5, 0.5, 0});
        m.add(e);
        e.drive[0].channel = 1;
        m.add(e);
        std::vector<float> x(std::size_t{2} * other);
        m.process(other, reinterpret_cast<std::byte*>(x.data()));
        std::size_t sounds = 0;
        for (std::size_t k = 0; k < other; ++k) {
            sounds = x[2 * k] != 0.0F ? k : sounds;
            if (k > sounds + other / 20)
                break;
        }
        CHECK(m.driven(1) < other);
        CHECK(m.driven(1) >= static_cast<std::uint64_t>(0.5 * other));
        return static_cast<double>(sounds) / other;
    };
    const auto near = [](double s) { return doctest::Approx(s + 0.02).epsilon(1e-3); };
    CHECK(cut_s({}) == near(0.5));
    CHECK(cut_s({0.4}) == near(0.1));
    CHECK(cut_s({0.4, 0.0, 7.0}) == near(0.1));
    CHECK(cut_s({0.5}) == 0.0);    // it is closed from the first frame on
    CHECK(cut_s({3600.0}) == 0.0); // of a higher limit
    CHECK(cut_s({-1.0}) == near(0.5));
}

TEST_CASE("a channel that others drive is closed at the limit without a step, and opens at half of it")
{
    // 0.5 s of each second: who is closed at t with a level of 0.5 s, and a fade, opens 0.27 s later.
    const auto opens_s = [](double start_s, double end_s, std::vector<std::pair<double, double>> raised) {
        synth::mixer m(std::vector<double>(1, 1.0), format_kind::float32, 8, limit_time(0.5, 1.0));
        m.add(voice(start_s, end_s - start_s, 0.5));
        std::vector<float> x(std::size_t{2} * rate);
        std::size_t done = 0;
        for (const auto& [at_s, level_s] : raised) {
            const std::size_t to = static_cast<std::size_t>(std::llround(at_s * rate));
            m.process(to - done, reinterpret_cast<std::byte*>(&x[done]));
            m.raise(0, level_s);
            done = to;
        }
        m.process(x.size() - done, reinterpret_cast<std::byte*>(&x[done]));
        double step = 0.0;
        for (std::size_t k = 1; k < x.size(); ++k)
            step = std::max(step, std::abs(double{x[k]} - double{x[k - 1]}));
        CHECK(step < 0.11); // 0.5 * 2 pi / 32 of the carrier, and the onset
        const auto closed = static_cast<std::size_t>(std::llround((raised.front().first + 0.03) * rate));
        const auto again = std::find_if(x.begin() + static_cast<std::ptrdiff_t>(closed), x.end(),
                                        [](float v) { return std::abs(v) > 0.01F; });
        CHECK(std::all_of(x.begin() + static_cast<std::ptrdiff_t>(closed) - rate / 100, again,
                          [](float v) { return std::abs(v) <= 0.01F; }));
        return static_cast<double>(again - x.begin()) / rate;
    };
    const auto near = [](double s) { return doctest::Approx(s).epsilon(0.03); };
    CHECK(opens_s(0.0, 2.0, {{0.1, 0.5}}) == near(0.1 + 0.02 + 0.27));
    CHECK(opens_s(0.5, 2.0, {{0.3, 0.5}}) == near(0.3 + 0.25));             // while it rests
    CHECK(opens_s(0.0, 2.0, {{0.1, 0.5}, {0.3, 0.45}}) == near(0.3 + 0.2)); // once more while it is closed
}

TEST_CASE("without a limit drive time is counted where it is asked for, and nothing is cut")
{
    synth::guard_settings g;
    g.rate = rate;
    g.drive_frames = std::numeric_limits<double>::infinity();
    synth::mixer counts(std::vector<double>(1, 1.0), format_kind::float32, 8, g);
    synth::mixer none(std::vector<double>(1, 1.0), format_kind::float32, 8, {});
    std::vector<float> x(std::size_t{20} * rate);
    for (synth::mixer* m : {&counts, &none}) {
        m->raise(0, 5.0);
        m->add(voice(0.0, 20.0, 0.5));
        m->process(x.size(), reinterpret_cast<std::byte*>(x.data()));
        CHECK(m->counts().drives_cut == 0);
    }
    CHECK(counts.driven(0) == x.size());
    CHECK(none.driven(0) == 0);
}

TEST_CASE("on a rested array nothing waits; a piece that is too long alone has no room")
{
    const synth::drive_room r(2, {}, rate);
    CHECK(wait_s(r, piece({one(0.0, 5.0)}, -12.0), 3.0) == 0.0);
    CHECK(wait_s(r, piece({one(0.0, 5.1)}, -12.0), 3.0) == -1.0);
    CHECK(wait_s(r, piece({one(0.0, 5.1)}, -47.0), 3.0) == 0.0); // it heats nothing
    CHECK(wait_s(r, piece({one(0.0, 3.0), one(3.0, 3.0, 1)}, -12.0), 3.0) == 0.0);
    drive_limits none;
    none.max_drive_s = none.window_s;
    CHECK(wait_s(synth::drive_room(2, none, rate), piece({one(0.0, 500.0)}, -12.0), 0.0) == 0.0);
}

TEST_CASE("a piece waits until the level leaves room for it, counting its own tactors alone")
{
    synth::drive_room r(2, {}, rate);
    r.add_played_score(piece({one(0.0, 4.0)}, -12.0), 0);
    const score three = piece({one(0.0, 3.0)}, -12.0);
    // It may begin at a level of 2 s.
    CHECK(wait_s(r, three, 4.0) == doctest::Approx(2.0));
    CHECK(wait_s(r, three, 5.0) == doctest::Approx(1.0));
    CHECK(wait_s(r, three, 6.0) == 0.0);
    CHECK(wait_s(r, piece({one(0.0, 1.0)}, -12.0), 4.0) == 0.0);
    CHECK(wait_s(r, piece({one(0.0, 3.0, 1)}, -12.0), 4.0) == 0.0);
    // 2 s, a rest of 1 s, 3 s: 4 s more at the end.
    const score parts = piece({one(0.0, 2.0), one(3.0, 3.0)}, -12.0);
    CHECK(wait_s(r, parts, 4.0) == doctest::Approx(3.0));
    CHECK(wait_s(r, piece({one(2.0, 2.0)}, -12.0), 4.0) == 0.0); // it rests within the piece
    // A rest within a piece gives back no more than there was.
    r.add_played_score(piece({one(0.0, 0.5), one(9.0, 4.0)}, -12.0), 20 * rate);
    CHECK(wait_s(r, three, 33.0) == doctest::Approx(2.0));
    CHECK(r.rest_s() == 5.0);
    // Drives after a long rest in a piece count, too, and so does what others drove.
    synth::drive_room late(2, {}, rate);
    late.add_played_score(piece({one(6.0, 4.0)}, -12.0), 0);
    CHECK(wait_s(late, three, 10.0) == doctest::Approx(2.0));
    late.resume(std::vector{4.0});
    CHECK(wait_s(late, three, 0.0) == doctest::Approx(2.0));
    // A closed channel opens at half of 5 s.
    late.close(0);
    CHECK(wait_s(late, piece({one(0.0, 3.0, 1)}, -12.0), 0.0) == doctest::Approx(2.5 + 3.0));
    drive_limits short_rest{.max_drive_s = 4.0};
    short_rest.window_s = 5.0; // a second of rest takes 4 s away
    synth::drive_room s(2, short_rest, rate);
    s.add_played_score(piece({one(0.0, 4.0)}, -12.0), 0);
    CHECK(wait_s(s, three, 4.0) == doctest::Approx(0.75).epsilon(1e-3));
}

TEST_CASE("a limit on power is found to act where it changes samples")
{
    const auto acts = [](std::vector<burst> bursts, double power_dbfs, std::optional<double> rise_s = {}) {
        array a = row(2);
        for (tactor_spec& t : a.tactors)
            t.rise_s = rise_s;
        const render_options o{
            .rate = rate, .level_dbfs = -12.0, .limits = drive_limits{.power_dbfs = power_dbfs}};
        return synth::is_power_limited(score(a, make_plan(std::move(bursts)), o));
    };
    const std::vector<burst> together{one(0.0, 0.2), one(0.0, 0.2, 1)}; // 2 x -12 dB
    CHECK(acts(together, -9.1));
    CHECK_FALSE(acts(together, -8.8));
    CHECK_FALSE(acts(together, -5.0));
    CHECK_FALSE(acts({one(0.0, 0.2), one(0.3, 0.2, 1)}, -11.5));
    // A boost goes up to full scale.
    CHECK_FALSE(acts(together, 0.0));
    CHECK(acts(together, 0.0, 0.1));
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
            const score s = piece(bursts, uniform(-42.0, -12.0));
            const auto wait = r.wait(s, m.position());
            REQUIRE(wait);
            waited += *wait;
            rest(m, *wait);
            r.add_played_score(s, m.position());
            play(m, s);
            rest(m, static_cast<std::uint64_t>(uniform(0.0, 1.0) * rate));
            REQUIRE(m.counts().drives_cut == 0);
        }
        CHECK(waited < std::uint64_t{20} * 10 * rate);
    }
}

} // namespace drive_time_test
