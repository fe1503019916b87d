// SPDX-License-Identifier: MIT
// Sinks of a program that pace themselves.
#include <algorithm>
#include <span>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>
#include <tactor/sink.hpp>

#include "clock_runner.hpp"
#include "player_support.hpp"
#include "scores.hpp"

namespace paced_sink_test {

using namespace tactor;
using namespace tactor::test;

namespace {

stream_setup nine_channels()
{
    stream_setup s;
    s.name = "memory";
    s.channels = 9;
    s.rate = rate;
    return s;
}

// Frames that a sink was given; outlives it.
struct taken {
    std::vector<std::byte> bytes = {};
    std::uint64_t frames = 0;
    std::size_t most = 0;
    bool gapless = true;
};

class memory_sink final : public paced_sink {
public:
    memory_sink(const stream_setup& s, taken& into, std::uint64_t ends_after = UINT64_MAX)
        : paced_sink(s), taken_(into), ends_after_(ends_after)
    {
    }

private:
    io_kind take(std::uint64_t first, std::span<const std::byte> data) noexcept override
    {
        const std::size_t frames = data.size() / setup().frame_bytes();
        if (first >= ends_after_)
            return io_kind::lost;
        taken_.gapless = taken_.gapless && first == taken_.frames;
        taken_.frames += frames;
        taken_.most = std::max(taken_.most, frames);
        taken_.bytes.insert(taken_.bytes.end(), data.begin(), data.end());
        return io_kind::ok;
    }

    taken& taken_;
    std::uint64_t ends_after_;
};

} // namespace

TEST_CASE("a program's sink gets each frame once, at most a period at a time, with the renderer's bytes")
{
    taken t;
    const score s = random_score(4, 3);
    {
        player p(std::make_unique<memory_sink>(nine_channels(), t), palm(), patient());
        CHECK(p.setup().period_frames == 96);
        CHECK(p.setup().buffer_frames == 288);
        CHECK_FALSE(p.setup().has_clock);
        REQUIRE(p.wait(p.submit(s))->state == state_kind::finished);
    }
    CHECK(t.gapless);
    CHECK(t.most == 96);
    const auto expected = rendered(s, format_kind::s32);
    // The stroke's first frame is silent: look for its first sound.
    const auto sound = [](std::byte b) { return b != std::byte{0}; };
    const auto heard = std::find_if(t.bytes.begin(), t.bytes.end(), sound) - t.bytes.begin();
    const auto begins = std::find_if(expected.begin(), expected.end(), sound) - expected.begin();
    CHECK(part(t.bytes, static_cast<std::size_t>(heard - begins), expected.size()) == expected);
}

TEST_CASE("a program's sink that is lost ends the stream and the stroke")
{
    taken t;
    player p(std::make_unique<memory_sink>(nine_channels(), t, 4800), palm(), patient());
    try {
        const auto r = p.wait(p.submit(tone(10.0)));
        REQUIRE(r);
        CHECK(r->state == state_kind::interrupted);
    } catch (const error& e) { // on a busy machine the stream is over before the stroke comes
        CHECK(e.kind() == error_kind::runtime);
    }
    while (!p.ended()) // a stroke ends before its stream
        std::this_thread::yield();
    CHECK(t.frames == 4800);
}

TEST_CASE("a program's sink refuses impossible numbers")
{
    taken t;
    const auto with = [&](auto change) {
        stream_setup s = nine_channels();
        change(s);
        CHECK_THROWS_AS(memory_sink(s, t), error);
    };
    with([](stream_setup& s) { s.channels = 0; });
    with([](stream_setup& s) { s.rate = 0; });
    with([](stream_setup& s) { s.rate = 4'000'000'000; });
    with([](stream_setup& s) { s.period_frames = 4'000'000'000; });
    with([](stream_setup& s) { s.period_frames = 2; }); // 42 us
    with([](stream_setup& s) { s.period_frames = 100, s.buffer_frames = 199; });
}

} // namespace paced_sink_test
