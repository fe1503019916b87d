// SPDX-License-Identifier: MIT
// A device that keeps the audio thread at work without a pause.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <doctest/doctest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "has.hpp"
#include "scores.hpp"

namespace busy_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Plays all frames at once.
class hasty_sink final : public sink {
public:
    hasty_sink() { REQUIRE(ready_ >= 0); }
    ~hasty_sink() override { ::close(ready_); }
    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override { return io_kind::ok; }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::ok; }
    std::size_t max_descriptors() const noexcept override { return 1; }
    std::size_t descriptors(std::span<pollfd> fds) noexcept override
    {
        fds[0] = {.fd = ready_, .events = POLLIN, .revents = 0};
        return 1;
    }
    io_kind ready(std::span<pollfd>) noexcept override { return io_kind::ok; }
    io_result available() noexcept override { return {io_kind::ok, setup_.buffer_frames, 0}; }
    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const std::size_t n = frames.size() / setup_.frame_bytes();
        written_ += n;
        return {io_kind::ok, n, 0};
    }
    stream_position position() noexcept override
    {
        time_ns_ += 1'000'000;
        return {written_, written_, time_ns_, true};
    }
    void drop() noexcept override {}

private:
    stream_setup setup_{
        .name = "hasty", .channels = 9, .rate = rate, .period_frames = 96, .buffer_frames = 288};
    int ready_ = ::eventfd(1, EFD_CLOEXEC);
    std::uint64_t written_ = 0;
    std::int64_t time_ns_ = 0;
};

} // namespace

TEST_CASE("an audio thread that never rests gives up real time, reports it once, and plays on")
{
    std::atomic<bool> fifo{false};
    std::atomic<int> told{0};
    std::string text;
    player_options o = patient();
    o.realtime = true;
    o.log = [&](log_kind kind, std::string_view line) {
        fifo = fifo || line == "the audio thread has real-time priority";
        if (line.find("gave up") == std::string_view::npos)
            return;
        CHECK(kind == log_kind::warning);
        text = line;
        ++told;
        told.notify_all();
    };
    player p(std::make_unique<hasty_sink>(), palm(), o);
    if (fifo)
        told.wait(0);
    else
        MESSAGE("no real-time priority here: checks only that nothing is given up");
    CHECK_FALSE(p.stats().realtime);
    const auto r = p.wait(p.submit(tone(0.01)));
    REQUIRE(r);
    CHECK(r->state == state_kind::finished);
    p.stop();
    CHECK(told == (fifo ? 1 : 0));
    if (fifo)
        has(text,
            "the audio thread gave up its real-time priority: it had worked for some 0.1 s without a pause");
}

} // namespace busy_test
