// SPDX-License-Identifier: MIT
// Bytes at the DAC: the renderer's, bit for bit.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <random>
#include <span>

#include <doctest/doctest.h>

#include "rig.hpp"

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

// Adds a piece to a sum at a place. Floats: integers add only where both are exact.
void add(std::vector<std::byte>& sum, const std::vector<std::byte>& part, std::size_t at_bytes)
{
    for (std::size_t i = 0; i + 4 <= part.size() && at_bytes + i + 4 <= sum.size(); i += 4) {
        float a = 0;
        float b = 0;
        std::memcpy(&a, &sum[at_bytes + i], 4);
        std::memcpy(&b, &part[i], 4);
        a += b;
        std::memcpy(&sum[at_bytes + i], &a, 4);
    }
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
        r.play_out();
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.end(id).frames == s.frames());
        CHECK(r.captured(from, s.frames()) == rendered(s, f));
        CHECK_FALSE(r.first_sound(from + s.frames()));
        CHECK(r.captured(0, from) == std::vector<std::byte>(from * r.dac.frame_bytes()));
    }
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
    std::vector<std::byte> sum(rendered(a, format_kind::float32));
    sum.resize(std::max<std::size_t>(a.frames(), 5000 + b.frames()) * r.dac.frame_bytes());
    add(sum, rendered(b, format_kind::float32), 5000 * r.dac.frame_bytes());
    // The mixer adds in double: the last bit may differ from a sum of rounded values.
    const std::vector<std::byte> got = r.captured(from, sum.size() / r.dac.frame_bytes());
    double worst = 0.0;
    for (std::size_t i = 0; i < sum.size(); i += 4) {
        float x = 0;
        float y = 0;
        std::memcpy(&x, &sum[i], 4);
        std::memcpy(&y, &got[i], 4);
        worst = std::max(worst, static_cast<double>(std::abs(x - y)));
    }
    CHECK(worst < 1e-7);
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
        r.play_out();
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.captured(at, s.frames()) == rendered(s, format_kind::s32));
        CHECK(r.captured(0, at) == std::vector<std::byte>(at * r.dac.frame_bytes()));
    }
}

TEST_CASE("a stroke for a frame that is over starts now")
{
    rig r;
    r.play(9600);
    const std::uint64_t next = r.status().written;
    const score s = random_score(9, 2);
    r.submit(s, 17);
    r.play_out();
    CHECK(r.captured(next, s.frames()) == rendered(s, format_kind::s32));
}

TEST_CASE("a tiny ring delays drives and loses none")
{
    for (const std::size_t ring : {2U, 4U, 7U}) {
        CAPTURE(ring);
        rig r({.ring = ring});
        // A drive a burst and a burst each 70 ms: one command a period is enough.
        const score s = random_score(11, 40);
        const std::uint64_t from = r.status().written;
        const stroke_id id = r.submit(s);
        r.play_out();
        CHECK(r.end(id).state == state_kind::finished);
        CHECK(r.captured(from, s.frames()) == rendered(s, format_kind::s32));
    }
}

TEST_CASE("a mixer without space makes drives wait in the ring")
{
    rig r({.loop = {.drives = 4}});
    const score s = random_score(12, 40);
    const std::uint64_t from = r.status().written;
    const stroke_id id = r.submit(s);
    r.play_out();
    CHECK(r.end(id).state == state_kind::finished);
    CHECK(r.captured(from, s.frames()) == rendered(s, format_kind::s32));
}

TEST_CASE("three hundred strokes at once wait for a place, and each ends once")
{
    rig r;
    for (int i = 0; i < 300; ++i)
        r.submit(tone(0.02));
    r.play_out();
    CHECK(r.ended.size() == 300);
    for (const auto& [id, reports] : r.ended) {
        REQUIRE(reports.size() == 1);
        CHECK(reports[0].state == state_kind::finished);
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

} // namespace bytes_test
