// SPDX-License-Identifier: MIT
// Lines of a player: sync pulses (which, when, in which order, and their counts), and the amplifier on a
// paced null PCM in real time, or on a DAC that stands still.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <poll.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "count_allocations.hpp"
#include "engine/control/line_threads.hpp"
#include "player_support.hpp"
#include "rt/clock.hpp"
#include "scores.hpp"

namespace player_lines_test {

using namespace tactor;
using namespace tactor::test;
using engine::clock_line;
using engine::pulse;

namespace {

constexpr std::int64_t us = 1000;

/// Sleeps too long by a given time.
struct fake_time final : engine::pulse_time {
    std::int64_t now() noexcept override { return t; }
    void sleep_until(std::int64_t until) noexcept override { t = std::max(t, until) + late; }
    std::int64_t t = 0;
    std::int64_t late = 0;
};

struct fake_output final : enable_line {
    explicit fake_output(fake_time& c) : clock(c) {}
    bool set(bool on) noexcept override
    {
        clock.t += cost;
        log.emplace_back(on, clock.t);
        return works;
    }
    fake_time& clock;
    std::int64_t cost = 30 * us;
    bool works = true;
    std::vector<std::pair<bool, std::int64_t>> log;
};

void send(engine::pulse_emitter& e, std::int64_t due_ns)
{
    if (e.await(due_ns))
        e.send(due_ns);
    else
        e.count_miss();
}

struct line_state {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<bool> log;
    bool works = true;

    void await(std::size_t n)
    {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return log.size() >= n; });
    }
};

class watched_line final : public enable_line {
public:
    explicit watched_line(std::shared_ptr<line_state> s) : state_(std::move(s)) {}
    bool set(bool on) noexcept override
    {
        const std::lock_guard lock(state_->mutex);
        state_->log.push_back(on);
        state_->changed.notify_all();
        return state_->works;
    }

private:
    std::shared_ptr<line_state> state_;
};

player_lines with(const std::shared_ptr<line_state>& s)
{
    player_lines l{.amplifier = std::make_unique<watched_line>(s)};
    return l;
}

// Only a failure takes so long.
constexpr std::chrono::seconds long_enough(60);

/// Counts the heap calls of the thread that switches it, from the first time on.
class counting_output final : public enable_line {
public:
    bool set(bool) noexcept override
    {
        if (!count_)
            count_.emplace();
        calls = count_->calls();
        return true;
    }
    std::uint64_t calls = 0;

private:
    std::optional<count_allocations> count_;
};

// Plans pulses 5 ms from now on, more than there are places, and waits until all were sent or missed.
void send_many(enable_line& line)
{
    constexpr std::uint32_t pulses = engine::pulse_board::places + 100;
    engine::link link;
    const clock_line clock{
        .epoch = 1, .first = 0, .frame = 0, .time_ns = rt::monotonic_ns(), .ns_per_frame = 1e9 / 48000};
    link.sync_clock.store(clock);
    engine::trigger_thread t(link, line, 10 * us, {.name = "test-sync"});
    for (std::uint32_t n = 1; n <= pulses; ++n)
        t.add({n}, 240 + 5 * std::uint64_t{n}, clock);
    for (engine::pulse_stats s; s.sent + s.missed < pulses; s = t.stats()) {
        pollfd fd{.fd = link.to_control.fd(), .events = POLLIN, .revents = 0};
        REQUIRE(::poll(&fd, 1, -1) == 1);
        link.to_control.consume();
        t.hand_over();
    }
    CHECK(t.stats().sent + t.stats().missed == pulses);
}

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

TEST_CASE("a pulse goes on at its time, less the cost of the call, and off after its length")
{
    fake_time t;
    fake_output line(t);
    engine::pulse_emitter e(line, 5'000 * us, t);
    for (int i = 1; i <= 10; ++i)
        send(e, i * 100'000 * us);
    REQUIRE(line.log.size() == 20);
    for (int i = 1; i <= 10; ++i) {
        const auto& [on, on_at] = line.log[2 * i - 2];
        const auto& [off, off_at] = line.log[2 * i - 1];
        CHECK(on);
        CHECK_FALSE(off);
        CHECK(on_at - i * 100'000 * us == (i == 1 ? 30 * us : 0));
        CHECK(off_at - on_at == 5'030 * us);
    }
    CHECK(e.stats().sent == 10);
    CHECK(e.stats().worst_late_s == doctest::Approx(30e-6));
    CHECK(e.stats().mean_late_s == doctest::Approx(3e-6));
}

TEST_CASE("lateness is counted, and a pulse that is far too late is not sent")
{
    fake_time t;
    fake_output line(t);
    line.cost = 0;
    engine::pulse_emitter e(line, 5'000 * us, t);
    t.late = 700 * us;
    send(e, 10'000 * us);
    CHECK(e.stats().worst_late_s == doctest::Approx(700e-6));
    t.t = 1'000'000 * us;
    send(e, 900'000 * us);
    CHECK(e.stats().sent == 1);
    CHECK(e.stats().missed == 1);
    CHECK(line.log.size() == 2);
}

TEST_CASE("a pulse called off while it waits is not sent; a line that fails is counted")
{
    fake_time t;
    fake_output line(t);
    engine::pulse_emitter e(line, 5'000 * us, t);
    CHECK(e.await(10'000 * us)); // and no more
    CHECK(line.log.empty());
    CHECK(e.stats().sent + e.stats().missed == 0);
    line.works = false;
    send(e, 20'000 * us);
    CHECK(e.stats().missed == 1);
    CHECK_FALSE(line.log.back().first);
}

TEST_CASE("the player sends or misses one pulse for each stroke")
{
    const auto state = std::make_shared<line_state>();
    std::uint64_t sent = 0;
    {
        player_lines lines{.sync_out = std::make_unique<watched_line>(state), .pulse_s = 0.001};
        player p(open_alsa(nine()), palm(), patient(), std::move(lines));
        for (int i = 0; i < 3; ++i) {
            // A busy machine may miss one, and be so late that its stroke is over: that is counted.
            const stroke_id id = p.submit(tone(i == 0 ? 0.01 : endless_s));
            const auto settled = [&] {
                const player_stats s = p.stats();
                return s.sync_pulses + s.sync_missed == static_cast<std::uint64_t>(i) + 1;
            };
            std::unique_lock lock(state->mutex);
            while (!settled())
                state->changed.wait_for(lock, std::chrono::milliseconds(10));
            lock.unlock();
            sent = p.stats().sync_pulses;
            if (i > 0)
                CHECK(p.cancel(id));
            CHECK(p.wait(id)->state == (i == 0 ? state_kind::finished : state_kind::cancelled));
        }
    }
    REQUIRE(state->log.size() >= 2 * sent);
    for (std::size_t i = 0; i < 2 * sent; ++i)
        CHECK(state->log[i] == (i % 2 == 0));
    CHECK((state->log.empty() || !state->log.back()));
}

TEST_CASE("the thread sends or misses each of more pulses than there are places")
{
    counting_output line;
    send_many(line);
}

COUNTING_TEST_CASE("the thread that sends pulses calls no heap")
{
    counting_output line;
    send_many(line);
    CHECK(line.calls == 0);
}

TEST_CASE("a pulse whose epoch ends while its sender waits for its time is not sent")
{
    // Time that jumps to where the sender sleeps, as an xrun begins another epoch.
    class xrun_time final : public engine::pulse_time {
    public:
        explicit xrun_time(engine::link& l) : link_(l) {}
        std::int64_t now() noexcept override { return t_; }
        void sleep_until(std::int64_t time_ns) noexcept override
        {
            t_ = time_ns;
            link_.sync_clock.store(clock_from(2, 1000));
        }

    private:
        engine::link& link_;
        std::int64_t t_ = 0;
    };
    engine::link link;
    xrun_time time(link);
    const auto state = std::make_shared<line_state>();
    watched_line line(state);
    const clock_line clock = clock_from(1, 0);
    link.sync_clock.store(clock);
    {
        engine::trigger_thread t(link, line, 10 * us, {.name = "test-sync"}, &time);
        t.add({1}, 48, clock); // due after 1 ms
        pollfd fd{.fd = link.to_control.fd(), .events = POLLIN, .revents = 0};
        REQUIRE(::poll(&fd, 1, -1) == 1);
        CHECK(t.stats().sent == 0);
    }
    CHECK(std::count(state->log.begin(), state->log.end(), true) == 0);
}

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

TEST_CASE("the amplifier waits until the DAC has played for the given time")
{
    const auto state = std::make_shared<line_state>();
    player_lines l = with(state);
    l.proof_s = 0.3;
    player p(open_alsa(nine()), palm(), patient(), std::move(l));
    state->await(1);
    CHECK(p.position().played >= 14400);
    p.stop();
    CHECK(state->log == std::vector<bool>{true, false});
}

TEST_CASE("the player switches its amplifier on once, plays, and off once")
{
    const auto state = std::make_shared<line_state>();
    std::uint64_t stalls = 0;
    {
        player p(open_alsa(nine()), palm(), {}, with(state));
        const auto report = p.wait(p.submit(tone(0.05)));
        REQUIRE(report);
        state->await(1);
        p.stop();
        stalls = p.stats().stalls;
        // On a busy machine the watchdog may have acted.
        if (stalls == 0)
            CHECK(report->state == state_kind::finished);
    }
    CHECK_FALSE(state->log.back());
    if (stalls == 0)
        CHECK(state->log == std::vector<bool>{true, false});
    for (std::size_t i = 0; i < state->log.size(); ++i)
        CHECK(state->log[i] == (i % 2 == 0));
}

TEST_CASE("a player destroyed at any moment leaves its amplifier off")
{
    for (int i = 0; i < 20; ++i) {
        const auto state = std::make_shared<line_state>();
        {
            player p(open_alsa(nine()), palm(), {}, with(state));
            p.submit(tone(0.01));
            if (i % 2 == 1)
                state->await(1);
        }
        CHECK((state->log.empty() || !state->log.back()));
    }
}

TEST_CASE("an amplifier whose line fails ends the player's stream")
{
    const auto state = std::make_shared<line_state>();
    state->works = false;
    std::optional<player> p(std::in_place, open_alsa(nine()), palm(), player_options{}, with(state));
    CHECK(play_to_failure(*p, tone(0.05)).find("the amplifier's line cannot be switched") !=
          std::string::npos);
    p->stop();
    CHECK_THROWS_AS(p->submit(tone(0.05)), error);
    // It refuses to go off as well.
    REQUIRE(p->ended());
    CHECK(p->ended()->reason == reason_kind::left_on);
    CHECK(p->ended()->why == "the amplifier's line cannot be switched off: it may be on");
    CHECK(p->stats().left_on);
    // Each try but the first was to switch it off. The last one is counted a moment later.
    const auto tries = [&] {
        const std::lock_guard lock(state->mutex);
        return state->log.size();
    };
    while (p->stats().off_failures != tries() - 1)
        std::this_thread::yield();
    // At its end it tries once more.
    const std::size_t before = tries();
    p.reset();
    CHECK(tries() == before + 1);
}

TEST_CASE("cancel() is reported without a frame being played")
{
    player_lines lines = with(std::make_shared<line_state>());
    lines.settle_s = 600.0;
    dac_player p(patient(), std::move(lines));
    const stroke_id score = p.submit(tone(1.0));
    const live_stroke live = p.begin({.timeout_s = 86400.0});
    CHECK_FALSE(p.wait(score, std::chrono::nanoseconds(1)));
    CHECK(p.cancel(score));
    CHECK(p.cancel(live.id()));
    for (const stroke_id id : {score, live.id()}) {
        const auto r = p.wait(id, long_enough);
        REQUIRE(r);
        CHECK(r->state == state_kind::cancelled);
        CHECK(r->frames == 0);
    }
    CHECK(p.position().played == 0);
    const running_clock clock(p.dac);
    p.stop();
}

} // namespace player_lines_test
