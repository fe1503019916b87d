// SPDX-License-Identifier: MIT
// A run whose device is lost and comes back, on devices whose clock the test has.
#include "session/play_session.hpp"

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <unistd.h>

#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "player_support.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace play_session_test {

using namespace tactor;
using namespace tactor::test;

namespace {

/// A line that goes on and never off again.
class stuck_line final : public enable_line {
public:
    explicit stuck_line(std::atomic<bool>& on) : on_(on) {}
    bool set(bool on) noexcept override
    {
        on_ = on_ || on;
        return on;
    }

private:
    std::atomic<bool>& on_;
};

/// A line whose holder can be lost.
class mortal_line final : public enable_line {
public:
    struct state {
        std::atomic<bool> lost = false;
        std::atomic<bool> on = false;
    };
    explicit mortal_line(state& s) : state_(s) {}
    bool set(bool on) noexcept override
    {
        state_.on = on && !state_.lost;
        return !on || !state_.lost;
    }
    bool beat() noexcept override { return !state_.lost; }

private:
    state& state_;
};

/// A run on a new card each time that its device is opened.
struct run {
    std::list<fake_dac> cards;
    std::list<running_clock> clocks;
    std::function<void()> before_open = [] {};
    std::atomic<bool> amplifier_on = false;
    session::environment where;
    std::optional<session::play_session> session;

    /// `device`: none: its drive time begins anew each time. `tick`: called after each period, in the thread
    /// of the clock; then the card keeps what it plays.
    explicit run(double reopen_s, bool stuck = false, const std::string& device = {},
                 const std::function<void()>& tick = {},
                 const std::function<void(session::stream_parts&)>& change = {})
    {
        using kept = running_clock::capture_kind;
        where.tactors = palm();
        where.config.limits.emplace();
        where.config.limits->max_drive_s = 0.5;
        where.config.limits->window_s = 3600.0; // of a clock that runs as fast as it can
        session::stream_options o;
        o.reopen_s = reopen_s;
        session.emplace(nine(), o, where, [this, stuck, device, tick, change](session::stream_parts& p) {
            p.open = [this, device, tick] {
                before_open();
                clocks.clear();
                cards.emplace_back();
                auto s = alsa::adopt(cards.back().pcm(), nine(), false, device);
                clocks.emplace_back(
                    cards.back(), tick ? kept::kept : kept::dropped, tick ? tick : [] {});
                return s;
            };
            if (stuck) // elsewhere none: it would be switched off where a machine is slow
                p.lines = session::lent_lines({.amplifier = std::make_unique<stuck_line>(amplifier_on)});
            p.player = patient(p.player.limits);
            p.player.realtime = false;
            p.times.retry_s = 0.001;
            p.times.proof_s = 0.001;
            if (change)
                change(p);
        });
    }
    ~run()
    {
        session.reset();
        clocks.clear();
    }

    stroke_report play(double seconds)
    {
        const auto ended = session->submit(tone(seconds));
        return ended ? *ended : session->follow();
    }
    // While the clock runs: a device that stands still is not asked any more whether it is there.
    void unplug()
    {
        cards.back().disconnect();
        while (!session->lost())
            session->wait_for(-1, 1);
        clocks.clear();
    }
};

// Returns what is printed on standard error meanwhile.
std::string capture_errors(const std::function<void()>& work)
{
    const int before = ::dup(STDERR_FILENO);
    std::FILE* file = std::tmpfile();
    REQUIRE(file != nullptr);
    ::dup2(::fileno(file), STDERR_FILENO);
    work();
    ::dup2(before, STDERR_FILENO);
    ::close(before);
    std::string text(4096, '\0');
    std::rewind(file);
    text.resize(std::fread(text.data(), 1, text.size(), file));
    std::fclose(file);
    return text;
}

// Returns the frames in which sound begins on channel 3, after a silence that a sine does not have.
std::vector<std::uint64_t> find_begins(const std::vector<std::byte>& bytes)
{
    std::vector<std::uint64_t> begins;
    std::uint64_t silent = 48000;
    for (std::uint64_t i = 0; (i + 1) * 36 <= bytes.size(); ++i) {
        std::int32_t v = 0;
        std::memcpy(&v, bytes.data() + i * 36 + 4 * 3, sizeof v);
        if (v != 0 && silent > 100)
            begins.push_back(i);
        silent = v == 0 ? silent + 1 : 0;
    }
    return begins;
}

} // namespace

TEST_CASE("that drive time does not count on is said once, of a device that keeps it")
{
    const auto count = [](const std::string& device) {
        const std::string said = capture_errors([&] {
            run r(60.0, false, device);
            r.unplug();
            r.session->reopen();
            r.session->finish();
        });
        CAPTURE(said);
        const std::string warning =
            "there is no runtime folder (XDG_RUNTIME_DIR): the next run will not know";
        const std::size_t first = said.find(warning);
        return first == std::string::npos ? 0 : said.find(warning, first + 1) == std::string::npos ? 1 : 2;
    };
    CHECK(count("a card that somebody feels") == 1);
    CHECK(count("") == 0);
}

TEST_CASE("drive time and counters go on over a device that was lost")
{
    run r(60.0, false, "card that comes back");
    CHECK(r.play(0.3).state == state_kind::finished);
    const player_stats before = r.session->stats();
    r.unplug();
    CHECK(r.session->reopen());
    CHECK_FALSE(r.session->lost());
    CHECK(r.cards.size() == 2);
    CHECK(r.session->stats().frames >= before.frames);
    CHECK(r.play(0.3).state == state_kind::finished);
    const session::run_facts all = r.session->finish();
    CHECK(all.reopened == 1);
    CHECK(all.stats.drives_cut == 1); // 0.6 s of 0.5 s
    CHECK(all.stats.frames > before.frames);
    CHECK_FALSE(all.stats.left_on);
}

TEST_CASE("a device that is not waited for stays lost")
{
    run r(0.0);
    r.unplug();
    CHECK_FALSE(r.session->reopen());
    CHECK(r.session->lost());
    CHECK(r.cards.size() == 1);
}

TEST_CASE("a device that does not come back is given up when the time is over")
{
    run r(0.05);
    r.unplug();
    int tries = 0;
    r.before_open = [&] {
        ++tries;
        throw error(error_kind::not_available, "card", "it is not there");
    };
    CHECK_FALSE(r.session->reopen());
    CHECK(tries >= 1);
    CHECK(r.session->position().played == 0);
    CHECK(r.session->finish().reopened == 0);
}

TEST_CASE("a device that can never be opened is not waited for")
{
    run r(3600.0);
    r.unplug();
    r.before_open = [] { throw error(error_kind::bad_input, "card", "it has two channels"); };
    CHECK_THROWS_AS(r.session->reopen(), error);
}

TEST_CASE("with an amplifier that may be on, a lost device is not opened again")
{
    run r(3600.0, true);
    while (!r.amplifier_on)
        r.session->wait_for(-1, 1);
    r.unplug();
    CHECK_FALSE(r.session->reopen());
    CHECK(r.cards.size() == 1);
    const session::run_facts all = r.session->finish();
    CHECK(all.stats.left_on);
    CHECK_THROWS_AS(all.check_amplifier(), error);
}

TEST_CASE("an amplifier's line that was lost is opened anew for the next stream, once it can be")
{
    std::list<mortal_line::state> lines(1);
    int failures = 2;
    run r(3600.0, false, {}, {}, [&](session::stream_parts& p) {
        p.lines = session::lent_lines({.amplifier = std::make_unique<mortal_line>(lines.back())});
        p.open_amplifier = [&] {
            if (failures-- > 0)
                throw error(error_kind::not_available, "chip", "it is not there");
            return std::make_unique<mortal_line>(lines.emplace_back());
        };
    });
    const auto await = [&r](const std::atomic<bool>& on) {
        while (!on)
            r.session->wait_for(-1, 1);
    };
    await(lines.back().on);
    lines.back().lost = true;
    while (!r.session->lost())
        r.session->wait_for(-1, 1);
    REQUIRE(r.session->reopen());
    CHECK(failures == -1);
    REQUIRE(lines.size() == 2);
    await(lines.back().on);
    CHECK(r.session->finish().reopened == 1);
    CHECK_FALSE(lines.back().on);
}

TEST_CASE("a signal ends the stream, with all that plays, not one stroke alone")
{
    run r(0.0);
    REQUIRE_FALSE(r.session->submit(tone(3600.0)).has_value());
    REQUIRE_FALSE(r.session->submit(tone(3600.0)).has_value());
    REQUIRE(::kill(::getpid(), SIGINT) == 0);
    CHECK(r.session->follow().state == state_kind::cancelled);
    CHECK(r.session->signal() == SIGINT);
    CHECK(r.session->lost()); // the first stroke would go on in a stream that has not ended
}

TEST_CASE("rounds begin as many frames apart as they were asked for")
{
    // The clock goes on by at most ten periods for each look at the stroke, so that no stroke is overlooked.
    std::atomic<int> periods = 1000;
    std::atomic<bool> free = false;
    run r(0.0, false, {}, [&] {
        while (!free && periods-- <= 0)
            std::this_thread::yield();
    });
    const score s = tone(0.1, 3);
    constexpr std::uint64_t apart = 48000 + 4801;
    for (int k = 0; k < 3; ++k) {
        r.session->queue_next(k < 2 ? &s : nullptr, apart);
        REQUIRE_FALSE(r.session->submit(s));
        const stroke_report end = r.session->follow([&] {
            periods = 10;
            return session::look{.most_ms = 1};
        });
        CHECK(end.state == state_kind::finished);
        CHECK(end.frames == 4800);
    }
    free = true;
    r.session->finish();
    r.clocks.clear();
    // The first sample of each round is a zero of the sine.
    const auto begins = find_begins(r.cards.back().captured());
    REQUIRE(begins.size() == 3);
    CHECK(begins[1] - begins[0] == apart);
    CHECK(begins[2] - begins[1] == apart);
}

TEST_CASE("rounds that end before anybody looks are also as many frames apart as they were asked for")
{
    std::atomic<int> periods = 1000;
    std::atomic<bool> free = false;
    run r(0.0, false, {}, [&] {
        while (!free && periods-- <= 0)
            std::this_thread::yield();
    });
    const score s = tone(0.1, 3);
    constexpr std::uint64_t apart = 96000;
    std::uint64_t ends = 0; // at this frame of the DAC the round has ended, but the next is not due
    for (int k = 0; k < 3; ++k) {
        r.session->queue_next(k < 2 ? &s : nullptr, apart);
        ends = k == 0 ? r.session->position().played + apart / 2 : ends + apart;
        REQUIRE_FALSE(r.session->submit(s));
        while (r.session->position().played < ends) {
            periods = 10;
            r.session->wait_for(-1, 1);
        }
        r.session->wait_for(-1, 100); // usually enough for the report; if not, this round tests nothing
        const stroke_report end = r.session->follow([&] {
            periods = 10;
            return session::look{.most_ms = 1};
        });
        CHECK(end.state == state_kind::finished);
        CHECK(end.late_s == 0.0);
    }
    free = true;
    r.session->finish();
    r.clocks.clear();
    const auto begins = find_begins(r.cards.back().captured());
    REQUIRE(begins.size() == 3);
    CHECK(begins[1] - begins[0] == apart);
    CHECK(begins[2] - begins[1] == apart);
}

TEST_CASE("a stroke plays by one call, and what cannot begin is thrown")
{
    const array a = preset_array("palm-3x3");
    const stroke s = preset_stroke("park2016-1");
    const stroke_report end = play("null", a, s, {.level_dbfs = -40.0});
    CHECK(end.state == state_kind::finished);
    CHECK(end.frames == score(a, make_plan(a, s)).frames());
    CHECK_THROWS_AS(static_cast<void>(play("null", a, s, {.level_dbfs = 3.0})), error);
    CHECK_THROWS_AS(static_cast<void>(play("no such card", a, s)), error);
}

} // namespace play_session_test
