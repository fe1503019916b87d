// SPDX-License-Identifier: MIT
// Sync pulses: which, when, and their counts; on virtual time, and once with the real thread.

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <vector>

#include <doctest/doctest.h>
#include <poll.h>

#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "count_allocations.hpp"
#include "engine/control/trigger_thread.hpp"
#include "player_support.hpp"
#include "rt/clock.hpp"
#include "scores.hpp"

namespace pulses_test {

using namespace tactor;
using namespace tactor::test;
using engine::clock_line;

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
        e.miss();
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

namespace {

struct pulse_log {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<std::pair<bool, std::int64_t>> log;
};

class logged_output final : public enable_line {
public:
    explicit logged_output(std::shared_ptr<pulse_log> l) : log_(std::move(l)) {}
    bool set(bool on) noexcept override
    {
        timespec t{};
        clock_gettime(CLOCK_MONOTONIC, &t);
        const std::lock_guard lock(log_->mutex);
        log_->log.emplace_back(on, std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec);
        log_->changed.notify_all();
        return true;
    }

private:
    std::shared_ptr<pulse_log> log_;
};

} // namespace

TEST_CASE("the player sends or misses one pulse for each stroke")
{
    const auto log = std::make_shared<pulse_log>();
    std::uint64_t sent = 0;
    {
        player_lines lines;
        lines.sync_out = std::make_unique<logged_output>(log);
        lines.pulse_s = 0.001;
        player p(open_alsa(nine()), palm(), patient(), std::move(lines));
        for (int i = 0; i < 3; ++i) {
            // A busy machine may miss one, and be so late that its stroke is over: that is counted.
            const stroke_id id = p.submit(tone(i == 0 ? 0.01 : endless_s));
            const auto settled = [&] {
                const player_stats s = p.stats();
                return s.sync_pulses + s.sync_missed == static_cast<std::uint64_t>(i) + 1;
            };
            std::unique_lock lock(log->mutex);
            while (!settled())
                log->changed.wait_for(lock, std::chrono::milliseconds(10));
            lock.unlock();
            sent = p.stats().sync_pulses;
            if (i > 0)
                CHECK(p.cancel(id));
            const auto r = p.wait(id);
            REQUIRE(r);
            CHECK(r->state == (i == 0 ? state_kind::finished : state_kind::cancelled));
        }
    }
    REQUIRE(log->log.size() >= 2 * sent);
    for (std::size_t i = 0; i < 2 * sent; ++i)
        CHECK(log->log[i].first == (i % 2 == 0));
    CHECK((log->log.empty() || !log->log.back().first));
}

namespace {

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

} // namespace

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

} // namespace pulses_test
