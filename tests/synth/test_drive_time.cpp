// SPDX-License-Identifier: MIT
// Drive time of a tactor: counted by the final samples of its channel, over any window.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "pieces.hpp"
#include "rounds.hpp"
#include "synth/guard/guard.hpp"
#include "synth/mix/mixer.hpp"

namespace drive_time_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 8000;
constexpr std::size_t cycle = rate / 250;
constexpr std::size_t fade = rate / 50;

synth::drive_event voice(double start_s, double length_s, double from, double to, double cycles = 0.0)
{
    synth::drive_event e;
    e.start = static_cast<std::uint64_t>(std::llround(start_s * rate));
    e.length = static_cast<std::uint32_t>(std::llround(length_s * rate));
    e.window = e.length;
    e.cycles_per_frame = 250.0 / rate;
    e.phase_frame = static_cast<std::uint64_t>(std::llround(cycles * cycle));
    e.drives = 1;
    e.drive[0] = {from, to, 0};
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
    drive_limits l;
    l.max_drive_s = max_drive_s;
    l.window_s = window_s;
    return synth::make_guards(l, rate);
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
    p.cuts = m.drives_cut();
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

} // namespace

TEST_CASE("many weak strokes on one tactor are cut where a strong one is")
{
    const synth::guard_settings g = limit_time(5.0, 10.0);
    const played strong = play({voice(0.0, 20.0, decibels(-0.1))}, 20.0, g);
    const played weak =
        play(std::vector<synth::drive_event>(100, voice(0.0, 20.0, decibels(-40.1))), 20.0, g);
    CHECK(strong.cuts == 2);
    CHECK(weak.cuts == 2);
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

TEST_CASE("no window holds more than the limit and one fade, for any mix")
{
    std::mt19937_64 random(29);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    // Steps of a cycle, so that gaps differ from zero crossings.
    const auto whole = [](double s) { return std::round(s * 250.0) / 250.0; };
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
        const auto frames = [](double s) { return static_cast<std::size_t>(std::llround(s * rate)); };
        const played p = play(events, 14.0, limit_time(limit_s, window_s));
        CAPTURE(run);
        CAPTURE(limit_s);
        CAPTURE(window_s);
        CAPTURE(p.cuts);
        const std::size_t most = most_in_a_window(p.x, frames(window_s));
        CHECK(most <= frames(limit_s) + fade);
        if (p.cuts > 0)
            CHECK(most + frames(window_s) / 256 + fade >= frames(limit_s)); // and no earlier than needed
    }
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
        CHECK(play(events, 41.0, limit_time(4.9, 10.0)).cuts > 0);
    }
}

TEST_CASE("counting by grains of the window cuts at most a grain early")
{
    std::vector<synth::drive_event>
        events; // half of the time, in pieces of 4 ms: 78 grains of 39 ms are 3.04 s
    for (double t = 0.0; t < 25.0; t += 0.008)
        events.push_back(voice(t, 0.004, 0.7));
    CHECK(play(events, 25.0, limit_time(5.0 + 10.0 / 256, 10.0)).cuts == 0);
    CHECK(play(events, 25.0, limit_time(4.96, 10.0)).cuts > 0);
}

TEST_CASE("a quiet stroke on a channel that was cut is silent too, for any block size")
{
    const std::vector<synth::drive_event> events{voice(0.0, 1.5, 0.5), voice(0.1, 2.9, 0.003),
                                                 voice(2.4, 0.2, 0.008, 0.012)};
    const synth::guard_settings g = limit_time(0.5, 2.0);
    const played whole = play(events, 3.0, g);
    CHECK(std::all_of(whole.x.begin() + rate * 6 / 10, whole.x.begin() + rate * 2,
                      [](float v) { return v == 0; }));
    for (const std::size_t block : {1, 7, 160, 161, 500})
        CHECK(play(events, 3.0, g, 1.0, block).x == whole.x);
}

TEST_CASE("each drive that meets a closed channel counts, even a quiet one, for any block size")
{
    const synth::guard_settings g = limit_time(0.5, 2.0);
    const auto cuts = [&](std::vector<synth::drive_event> more, std::size_t block = 160) {
        more.insert(more.begin(), voice(0.0, 0.7, 0.5)); // closed from 0.5 s on, until 2.27 s
        return play(more, 3.0, g, 1.0, block).cuts;
    };
    CHECK(cuts({}) == 1);
    CHECK(cuts({voice(0.9, 0.1, 0.5)}) == 2);
    CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.2, 0.1, 0.003)}) == 3);
    CHECK(cuts({voice(2.5, 0.1, 0.5)}) == 1);                       // open again
    CHECK(cuts({voice(2.26, 0.2, 0.5)}) == 2);                      // faded in
    CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.0, 0.1, 0.5)}) == 2); // without a gap it is one
    CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.01, 0.1, 0.5)}) == 3);
    for (const std::size_t block : {1, 7, 161, 500})
        CHECK(cuts({voice(0.9, 0.1, 0.5), voice(1.2, 0.1, 0.003)}, block) == 3);
    // Its last sample is the last allowed one: nothing changes.
    CHECK(play({voice(0.0, 0.5, 0.5)}, 1.0, g).cuts == 0);
}

TEST_CASE("the next mixer counts on, at another rate, less the time between")
{
    const auto first = [] {
        synth::mixer m(std::vector<double>(2, 1.0), format_kind::float32, 8, limit_time(0.5, 1.0));
        m.add(voice(0.1, 0.4, 0.5));
        std::vector<float> x(rate);
        m.process(rate / 2, reinterpret_cast<std::byte*>(x.data()));
        return m.history();
    };
    const auto cut_s = [](const synth::drive_history& h) {
        constexpr unsigned other = 48000;
        drive_limits l;
        l.max_drive_s = 0.5;
        l.window_s = 1.0;
        synth::mixer m(std::vector<double>(2, 1.0), format_kind::float32, 8, synth::make_guards(l, other));
        m.resume(h);
        synth::drive_event e = voice(0.0, 1.0, 0.5);
        e.length = other;
        e.window = other;
        e.cycles_per_frame = 250.0 / other;
        m.add(e);
        e.drive[0].channel = 1;
        m.add(e);
        std::vector<float> x(std::size_t{2} * other);
        m.process(other, reinterpret_cast<std::byte*>(x.data()));
        std::size_t sounds = 0;
        for (std::size_t k = 0; k < other; ++k) {
            sounds = x[2 * k] != 0.0F ? k : sounds;
            if (k > sounds + other / 20) {
                break;
            }
        }
        return static_cast<double>(sounds) / other;
    };
    const auto near = [](double s) { return doctest::Approx(s + 0.02).epsilon(1e-3); };
    CHECK(cut_s({}) == near(0.5));
    CHECK(cut_s(first()) == near(0.1));
    synth::drive_history h = first();
    h.pass(0.45);
    CHECK(cut_s(h) == near(0.1));
    h.pass(0.1); // when 0.5 s are full, as much has left the window
    CHECK(cut_s(h) == near(0.5));
    h.pass(10.0);
    CHECK(cut_s(h) == near(0.5));
}

TEST_CASE("drive time handed from mixer to mixer gains no frame by rounding")
{
    const synth::guard_settings g = limit_time(9.0, 10.0);
    synth::mixer first(std::vector<double>(1, 1.0), format_kind::float32, 64, g);
    for (int i = 0; i < 40; ++i)
        REQUIRE(first.add(voice(0.2 * i, 0.1 + 0.0013 * i, 0.5)));
    std::vector<float> x(std::size_t{9} * rate);
    first.process(x.size(), reinterpret_cast<std::byte*>(x.data()));
    const synth::drive_history had = first.history();
    REQUIRE(had.channels.at(0).stretches.size() == 40);
    synth::mixer next(std::vector<double>(1, 1.0), format_kind::float32, 64, g);
    next.resume(had);
    const synth::drive_history has = next.history();
    REQUIRE(has.channels.at(0).stretches.size() == 40);
    for (std::size_t i = 0; i < 40; ++i) {
        const auto& a = had.channels[0].stretches[i];
        const auto& b = has.channels[0].stretches[i];
        CHECK(std::abs(b.begin_s - a.begin_s) < 0.1 / rate);
        CHECK(std::abs(b.end_s - a.end_s) < 0.1 / rate);
        CHECK(std::abs(b.driven_s - a.driven_s) < 0.1 / rate);
    }
}

TEST_CASE("a tactor that was cut stays cut in the next mixer")
{
    const synth::guard_settings g = limit_time(0.5, 1.0);
    synth::mixer a(std::vector<double>(1, 1.0), format_kind::float32, 8, g);
    a.add(voice(0.0, 2.0, 0.5));
    std::vector<float> x(2 * rate);
    a.process(rate * 6 / 10, reinterpret_cast<std::byte*>(x.data()));
    REQUIRE(a.drives_cut() == 1);
    synth::mixer b(std::vector<double>(1, 1.0), format_kind::float32, 8, g);
    b.resume(a.history());
    b.add(voice(0.0, 2.0, 0.5));
    b.process(2 * rate, reinterpret_cast<std::byte*>(x.data()));
    // Half of 0.52 s has left the window 1.27 s after the beginning.
    CHECK(std::all_of(x.begin(), x.begin() + rate * 66 / 100, [](float v) { return v == 0.0F; }));
    CHECK(std::any_of(x.begin() + rate * 67 / 100, x.begin() + rate * 70 / 100,
                      [](float v) { return v != 0.0F; }));
    CHECK(synth::mixer(std::vector<double>(1, 1.0), format_kind::float32).history().channels.empty());
}

} // namespace drive_time_test
