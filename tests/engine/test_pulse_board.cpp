// SPDX-License-Identifier: MIT
// Pulses on the board from which the sync thread takes them, and their order.
#include <algorithm>
#include <atomic>
#include <numeric>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "engine/control/trigger_thread.hpp"

namespace pulse_board_test {

using namespace tactor;
using engine::clock_line;
using engine::pulse;

namespace {

clock_line clock_from(std::uint64_t epoch, std::uint64_t first)
{
    return {.epoch = epoch, .first = first, .frame = first, .time_ns = 0, .ns_per_frame = 1e9 / 48000};
}

std::optional<pulse> next(const engine::pulse_board& b, std::uint64_t epoch)
{
    const auto seen = b.next(clock_from(epoch, 0));
    return seen ? std::optional(seen->what) : std::nullopt;
}

// Reports whether a stroke's pulse may be called off: some were sent before.
bool may_be_forgotten(stroke_id id)
{
    for (std::uint32_t by = id.number; by < id.number + 5; ++by)
        if (by % 3 == 0 && by - by % 5 == id.number)
            return true;
    return false;
}

} // namespace

TEST_CASE("pulses come in order of their frames, without those of other epochs and ended strokes")
{
    engine::pulse_board board;
    engine::pulse_plan p(board);
    CHECK(p.add({1}, 500, clock_from(1, 0)));
    CHECK(p.add({2}, 300, clock_from(1, 0)));
    CHECK(p.add({3}, 700, clock_from(1, 0)));
    CHECK(next(board, 1) == pulse{1, 300, 2});
    p.forget({2}, false);
    CHECK(next(board, 1) == pulse{1, 500, 1});
    CHECK(board.take(*board.next(clock_from(1, 0))));
    CHECK(next(board, 1) == pulse{1, 700, 3});
    CHECK_FALSE(next(board, 2));
    CHECK(p.add({4}, 900, clock_from(2, 800)));
    CHECK(next(board, 2) == pulse{2, 900, 4});
    CHECK_FALSE(next(board, 1));
    CHECK_FALSE(p.add({5}, 790, clock_from(2, 800))); // from before the xrun
    CHECK_FALSE(p.add({6}, 990, clock_from(0, 0)));   // between two epochs
    CHECK_FALSE(next(board, 2));
}

TEST_CASE("a pulse that was seen and then called off cannot be taken")
{
    engine::pulse_board board;
    engine::pulse_plan p(board);
    p.add({1}, 500, clock_from(1, 0));
    const auto seen = board.next(clock_from(1, 0));
    REQUIRE(seen);
    p.forget({1}, false);
    CHECK_FALSE(board.take(*seen));
    p.add({2}, 600, clock_from(1, 0)); // in the same place
    CHECK_FALSE(board.take(*seen));
    CHECK(next(board, 1) == pulse{1, 600, 2});
}

TEST_CASE("a stroke that was played before its pulse was taken has missed it")
{
    engine::pulse_board board;
    engine::pulse_plan p(board);
    for (std::uint32_t n = 1; n <= engine::pulse_board::places + 2; ++n)
        p.add({n}, n, clock_from(1, 0));
    p.forget({3}, true);
    CHECK(p.missed() == 1);
    p.forget({engine::pulse_board::places + 2}, true); // not on the board yet
    CHECK(p.missed() == 2);
    p.forget({4}, false); // it was cancelled before its first frame
    REQUIRE(board.take(*board.next(clock_from(1, 0))));
    p.forget({1}, true); // it has been sent
    p.forget({1}, true);
    CHECK(p.missed() == 2);
}

TEST_CASE("more pulses than places, planned in any order, all come in order")
{
    engine::pulse_board board;
    engine::pulse_plan p(board);
    std::vector<std::uint64_t> frames(5 * engine::pulse_board::places);
    std::iota(frames.begin(), frames.end(), 1);
    std::shuffle(frames.begin(), frames.end(), std::mt19937(3)); // NOLINT(cert-msc51-cpp)
    for (const std::uint64_t f : frames)
        p.add({static_cast<std::uint32_t>(f)}, f, clock_from(1, 0));
    p.forget({7}, false);
    p.forget({900}, false); // not on the board yet
    for (std::uint64_t f = 1; f <= frames.size(); ++f) {
        if (f == 7 || f == 900)
            continue;
        const auto seen = board.next(clock_from(1, 0));
        REQUIRE(seen);
        REQUIRE(seen->what == pulse{1, f, static_cast<std::uint32_t>(f)});
        REQUIRE(board.take(*seen));
        if (f % 100 == 0)
            p.hand_over();
    }
    CHECK_FALSE(next(board, 1));
    CHECK_FALSE(p.hand_over());
}

TEST_CASE("planned by one thread and sent by another, each pulse comes at most once and whole")
{
    constexpr std::uint32_t last = 20'000;
    engine::pulse_board board;
    std::vector<int> sent(last + 1, 0);
    std::atomic<bool> over{false};
    std::uint64_t wrong = 0;
    std::thread sender([&] {
        for (bool ends = false; !ends;) {
            ends = over;
            while (const auto s = board.next(clock_from(1, 0))) {
                wrong += static_cast<std::uint64_t>(s->what.frame != 3 * std::uint64_t{s->what.id.number});
                if (board.take(*s))
                    ++sent[s->what.id.number];
            }
        }
    });
    engine::pulse_plan p(board);
    for (std::uint32_t n = 1; n <= last; ++n) {
        p.add({n}, 3 * std::uint64_t{n}, clock_from(1, 0));
        if (n % 3 == 0)
            p.forget({n - n % 5}, false);
    }
    // An empty board takes waiting pulses, if there are any.
    for (bool empty = false, any = true; !empty || any;) {
        empty = !next(board, 1);
        any = p.hand_over();
        std::this_thread::yield();
    }
    over = true;
    sender.join();
    CHECK(wrong == 0);
    std::size_t strangers = 0;
    for (std::uint32_t n = 1; n <= last; ++n)
        strangers += static_cast<std::size_t>(sent[n] > 1 || (sent[n] == 0 && !may_be_forgotten({n})));
    CHECK(strangers == 0);
}

} // namespace pulse_board_test
