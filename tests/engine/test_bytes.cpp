// SPDX-License-Identifier: MIT
// Frames at the DAC: the renderer's, bit for bit, in time, of one stroke or of hundreds.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/plan.hpp>

#include "count_allocations.hpp"
#include "has.hpp"
#include "rig.hpp"
#include "rt/nonblocking.hpp"

namespace bytes_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Takes fewer frames than it could, and often none.
class stingy_sink final : public forwarding_sink {
public:
    using forwarding_sink::forwarding_sink;

    io_result write(std::span<const std::byte> frames) noexcept override
    {
        switch (random_() % 4) {
        case 0:
            return {};
        case 1:
            return {io_kind::again, 0, -EAGAIN};
        case 2:
            return write_first(1 + random_() % (frames.size() / setup().frame_bytes()), frames);
        default:
            return forwarding_sink::write(frames);
        }
    }

private:
    std::minstd_rand random_;
};

std::vector<float> read_floats(const std::vector<std::byte>& bytes)
{
    std::vector<float> all(bytes.size() / sizeof(float));
    std::memcpy(all.data(), bytes.data(), bytes.size());
    return all;
}

// A host's audio callback. tests/lanes/realtime checks that nothing in it allocates, locks or waits.
void call_back(renderer& r, std::span<std::byte> out) noexcept TACTOR_NONBLOCKING
{
    r.process(out);
}

constexpr unsigned period = 48;

// Plays frame by frame, so that a call may come at any phase of a period.
void frames(rig& r, std::uint64_t n)
{
    for (std::uint64_t i = 0; i < n; ++i) {
        r.dac.advance_queued(1);
        r.step();
        r.now -= static_cast<std::int64_t>(1e9 * period / rate); // step() counts a period
        r.now += static_cast<std::int64_t>(1e9 / rate);
        r.control();
    }
}

constexpr int crowd = 400;

score drawn(algorithm_kind how)
{
    plan_options o{.algorithm = how};
    const array a = palm();
    render_options r{.level_dbfs = -60.0};
    return {a, {{.plan = make_plan(a, preset_stroke("park2016-1"), o), .start_s = {}}}, r};
}

// Every tactor of 64 at once, twice.
score broad()
{
    burst b{.duration_s = 0.1};
    for (unsigned i = 0; i < 64; ++i)
        b.drives.push_back({.tactor = i, .amplitude = 1.0});
    burst second = b;
    second.onset_s = 0.05;
    render_options r{.level_dbfs = -60.0};
    return {make_grid("8x8", 8, 8, 20.0, 20.0), make_bursts({b, second}), r};
}

// Counts strokes by the state and reason of their end.
std::map<std::string, int> play_at_once(const score& s, std::uint64_t at, int strokes = crowd)
{
    rig_options o{.channels = s.channels()};
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

TEST_CASE("the DAC gets the renderer's bytes, in every format")
{
    for (const format_kind f : {format_kind::s16, format_kind::s32, format_kind::float32}) {
        CAPTURE(to_string(f));
        rig r({.format = f});
        const score s = random_score(7, 12);
        const std::uint64_t from = r.status().written;
        const stroke_id id = r.submit(s);
        CHECK(r.play_out(id).state == state_kind::finished);
        CHECK(r.end(id).frames == s.frames());
        CHECK(r.captured(from, s.frames()) == rendered(s, f));
        CHECK_FALSE(r.first_sound(from + s.frames()));
        CHECK(r.captured(0, from) == std::vector<std::byte>(from * r.dac.frame_bytes()));
    }
}

TEST_CASE("bursts of any sound are rendered in a host's own real-time callback, with limits and without")
{
    plan pieces[4]; // as a stroke's keys can say: a plain sine, and what needs more than that
    for (plan& p : pieces)
        p = make_plan(palm(), preset_stroke("park2016-3"));
    pieces[1].wave = {.kind = waveform_kind::noise, .low_hz = 60.0, .high_hz = 400.0};
    pieces[2].course = {{0.0, 60.0}, {1.0, 300.0}};
    pieces[3].wave.kind = waveform_kind::square;
    pieces[3].am = {.hz = 20.0, .depth = 0.8};
    std::vector<placed_plan> at_once;
    for (const plan& p : pieces)
        at_once.push_back({.plan = p, .start_s = 0.0});
    std::vector<std::vector<std::byte>> heard;
    for (const std::optional<drive_limits>& limits :
         {std::optional<drive_limits>{},
          std::optional{drive_limits{.power_dbfs = -30.0, .max_drive_s = 0.2}}}) {
        const score s(palm(), at_once, {.level_dbfs = -12.0, .limits = limits});
        std::vector<std::byte> out(s.frames() * s.channels() * sizeof(float));
        renderer r(s, format_kind::float32);
        const std::size_t block = 64 * s.channels() * sizeof(float);
        const count_allocations count; // counts nothing under RealtimeSanitizer, which counts itself
        for (std::size_t at = 0; at < out.size(); at += block)
            call_back(r, std::span(out).subspan(at, std::min(block, out.size() - at)));
        CHECK(count.calls() == 0);
        CHECK(out == rendered(s, format_kind::float32));
        heard.push_back(out);
    }
    CHECK(heard[0] != heard[1]); // the limits act
}

TEST_CASE("odd periods, one channel more and many buffers give the same bytes")
{
    std::mt19937_64 random(3);
    for (int round = 0; round < 20; ++round) {
        const auto period = static_cast<unsigned>(16 + random() % 700);
        const auto periods = static_cast<unsigned>(2 + random() % 6);
        CAPTURE(period);
        CAPTURE(periods);
        rig r({.channels = 10, .period = period, .periods = periods, .dac = {.least_period_bytes = 4}});
        r.options.period = r.out->setup().period_frames;
        const score s = random_score(random(), 6, 10);
        const std::uint64_t from = r.status().written;
        r.submit(s);
        r.play_out();
        CHECK(r.captured(from, s.frames()) == rendered(s, format_kind::s32));
    }
}

TEST_CASE("strokes that overlap add up, each at its place")
{
    rig r({.format = format_kind::float32});
    const score a = random_score(1, 8);
    const score b = random_score(2, 5);
    const std::uint64_t from = r.status().written;
    r.submit(a);
    r.submit(b, from + 5000);
    r.play_out();
    // Floats: integers add only where both are exact.
    std::vector<float> sum = read_floats(rendered(a, format_kind::float32));
    const std::vector<float> second = read_floats(rendered(b, format_kind::float32));
    const std::uint64_t length = std::max(a.frames(), 5000 + b.frames());
    sum.resize(length * a.channels());
    for (std::size_t i = 0; i < second.size(); ++i)
        sum[5000 * a.channels() + i] += second[i];
    // The mixer adds in double: the last bit may differ from a sum of rounded values.
    const std::vector<float> got = read_floats(r.captured(from, length));
    float worst = 0.0F;
    for (std::size_t i = 0; i < sum.size(); ++i)
        worst = std::max(worst, std::abs(sum[i] - got[i]));
    CHECK(static_cast<double>(worst) < 1e-7);
    CHECK(r.ended.size() == 2);
}

TEST_CASE("a stroke submitted now sounds in the next period that is written")
{
    std::mt19937_64 random(5);
    for (int round = 0; round < 50; ++round) {
        rig r;
        r.play(96 * (1 + random() % 50));
        const std::uint64_t captured = r.dac.captured_frames();
        r.submit(tone(0.05));
        r.dac.advance_queued(96);
        r.step();
        REQUIRE(r.dac.captured_frames() == captured + 96);
        // The first sample of a sine is 0.
        CHECK(r.first_sound() == captured + 1);
    }
}

TEST_CASE("a stroke submitted for a frame starts at that frame")
{
    std::mt19937_64 random(6);
    for (int round = 0; round < 30; ++round) {
        rig r;
        r.play(96 * (random() % 20));
        const std::uint64_t at = r.status().written + random() % 60'000;
        const score s = random_score(random(), 3);
        const stroke_id id = r.submit(s, at);
        CHECK(r.play_out(id).state == state_kind::finished);
        CHECK(r.captured(at, s.frames()) == rendered(s, format_kind::s32));
        CHECK(r.captured(0, at) == std::vector<std::byte>(at * r.dac.frame_bytes()));
    }
}

TEST_CASE("a tiny ring and a mixer without space delay drives and lose none")
{
    // A drive a burst and a burst each 70 ms: one command a period is enough.
    const score s = random_score(11, 40);
    for (const auto& [ring, drives] : {std::pair(2U, 8192U), {4U, 8192U}, {7U, 8192U}, {2048U, 4U}}) {
        CAPTURE(ring);
        rig r({.ring = ring, .loop = {.drives = drives}});
        const std::uint64_t from = r.status().written;
        CHECK(r.play_out(r.submit(s)).state == state_kind::finished);
        CHECK(r.captured(from, s.frames()) == rendered(s, format_kind::s32));
    }
}

TEST_CASE("short writes and writes of nothing lose no frame")
{
    rig r({.wrap = [](auto s) { return std::make_unique<stingy_sink>(std::move(s)); }});
    const score s = random_score(13, 20);
    const stroke_id id = r.submit(s);
    // Writes fail so often that the DAC must wait at times; it plays on with the frames it has.
    for (int i = 0; i < 20'000 && r.ended.empty(); ++i) {
        r.dac.advance_queued(24);
        r.step();
        r.control();
    }
    CHECK(r.end(id).state == state_kind::finished);
    CHECK(r.link.count.xruns == 0);
    REQUIRE(r.first_sound());
    CHECK(r.captured(*r.first_sound() - 1, s.frames()) == rendered(s, format_kind::s32));
}

TEST_CASE("48 frames x 3 at 48 kHz: in the device's buffer within a period, at the DAC within 4")
{
    std::mt19937_64 random(9);
    rig r({.channels = 9, .period = period, .periods = 3});
    frames(r, 500);
    std::uint64_t to_ring = 0;
    std::uint64_t to_dac = 0;
    for (int i = 0; i < 400; ++i) {
        frames(r, 1 + random() % 300);
        const std::uint64_t played = r.status().played;
        const std::uint64_t from = r.dac.captured_frames();
        const stroke_id id = r.submit(tone(0.004));
        // The call wakes the audio thread between two periods.
        r.loop.step(io_kind::again, r.now);
        std::uint64_t waited = 0;
        while (!r.first_sound(from)) {
            frames(r, 1);
            ++waited;
            REQUIRE(waited < 10 * period);
        }
        const std::uint64_t first = *r.first_sound(from) - 1;
        to_ring = std::max(to_ring, waited);
        to_dac = std::max(to_dac, first - played);
        while (!r.report(id))
            frames(r, 16);
    }
    CHECK(to_ring <= period);
    CHECK(to_dac <= 4 * period);
}

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
        has(end, "interrupted");
        has(end, "too many strokes at once (let fewer overlap");
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

} // namespace bytes_test
