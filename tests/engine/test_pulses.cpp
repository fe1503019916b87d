// SPDX-License-Identifier: MIT
// Sync pulses: which, when, and what is counted; on virtual time, and once with the real thread.
#include "engine/pulses.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <random>

#include <doctest/doctest.h>

#include <tactor/player.hpp>

#include "player_support.hpp"
#include "scores.hpp"

namespace pulses_test {

using namespace tactor;
using namespace tactor::test;
using engine::clock_line;
using engine::pulse;

namespace {

constexpr std::int64_t us = 1000;

/// Sleeps are late by what the test says.
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

clock_line line_of(std::uint64_t epoch, std::uint64_t first)
{
    return {.epoch = epoch, .first = first, .frame = first, .time_ns = 0, .ns_per_frame = 1e9 / 48000};
}

} // namespace

TEST_CASE("pulses come in order of their frames, those of other epochs and ended strokes not at all")
{
    engine::pulse_plan p;
    p.add({1, 500, 1});
    p.add({1, 300, 2});
    p.add({1, 700, 3});
    CHECK(p.next(line_of(1, 0)) == pulse{1, 300, 2});
    p.forget(2);
    CHECK(p.next(line_of(1, 0)) == pulse{1, 500, 1});
    p.take({1, 500, 1});
    CHECK(p.has({1, 700, 3}));
    p.add({2, 900, 4});
    CHECK(p.next(line_of(2, 800)) == pulse{2, 900, 4});
    CHECK_FALSE(p.has({1, 700, 3}));
    CHECK_FALSE(p.next(line_of(3, 1000)));
}

TEST_CASE("a pulse is switched on at its time, less what the call costs, and off after its length")
{
    fake_time t;
    fake_output line(t);
    engine::pulse_emitter e(line, 5'000 * us, t);
    for (int i = 1; i <= 10; ++i)
        e.send(i * 100'000 * us, [] { return true; });
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

TEST_CASE("lateness is counted, a pulse that is far too late is not sent")
{
    fake_time t;
    fake_output line(t);
    line.cost = 0;
    engine::pulse_emitter e(line, 5'000 * us, t);
    t.late = 700 * us;
    e.send(10'000 * us, [] { return true; });
    CHECK(e.stats().worst_late_s == doctest::Approx(700e-6));
    t.t = 1'000'000 * us;
    e.send(900'000 * us, [] { return true; });
    CHECK(e.stats().sent == 1);
    CHECK(e.stats().missed == 1);
    CHECK(line.log.size() == 2);
}

TEST_CASE("a pulse that is called off while it waits is not sent; a line that fails is counted")
{
    fake_time t;
    fake_output line(t);
    engine::pulse_emitter e(line, 5'000 * us, t);
    e.send(10'000 * us, [] { return false; });
    CHECK(line.log.empty());
    CHECK(e.stats().sent + e.stats().missed == 0);
    line.works = false;
    e.send(20'000 * us, [] { return true; });
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
        player p(open_alsa(nine()), palm(), {}, std::move(lines));
        for (int i = 0; i < 3; ++i) {
            const auto r = p.wait(p.submit(tone(0.06)));
            REQUIRE(r);
            REQUIRE(r->state == stroke_state::finished);
            // A machine that is busy may miss one: it says so.
            const auto settled = [&] {
                const player_stats s = p.stats();
                return s.sync_pulses + s.sync_missed == static_cast<std::uint64_t>(i) + 1;
            };
            std::unique_lock lock(log->mutex);
            while (!settled())
                log->changed.wait_for(lock, std::chrono::milliseconds(10));
            sent = p.stats().sync_pulses;
        }
    }
    REQUIRE(log->log.size() >= 2 * sent);
    for (std::size_t i = 0; i < 2 * sent; ++i)
        CHECK(log->log[i].first == (i % 2 == 0));
    CHECK((log->log.empty() || !log->log.back().first));
}

} // namespace pulses_test
