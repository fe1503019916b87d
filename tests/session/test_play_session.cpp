// SPDX-License-Identifier: MIT
// A run whose device is lost and comes back, on devices whose clock the test has.
#include "session/play_session.hpp"

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>

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

/// A run on a new card each time that its device is opened.
struct run {
    std::list<fake_dac> cards;
    std::list<running_clock> clocks;
    std::function<void()> before_open = [] {};
    std::atomic<bool> amplifier_on = false;
    session::environment where;
    std::optional<session::play_session> session;

    /// `device`: none: its drive time begins anew each time.
    explicit run(double reopen_s, bool stuck = false, const std::string& device = {})
    {
        where.tactors = palm();
        where.config.limits.emplace();
        where.config.limits->max_drive_s = 0.5;
        where.config.limits->window_s = 3600.0; // of a clock that runs as fast as it can
        session::stream_options o;
        o.reopen_s = reopen_s;
        session.emplace(nine(), o, where, [this, stuck, device](session::stream_parts& p) {
            p.open = [this, device] {
                before_open();
                clocks.clear();
                cards.emplace_back();
                auto s = alsa::adopt(cards.back().pcm(), nine(), false, device);
                clocks.emplace_back(cards.back());
                return s;
            };
            if (stuck) // elsewhere none: it would be switched off where a machine is slow
                p.lines = session::lent_lines({.amplifier = std::make_unique<stuck_line>(amplifier_on)});
            p.player = patient(p.player.limits);
            p.player.realtime = false;
            p.times.retry_s = 0.001;
            p.times.proof_s = 0.001;
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

} // namespace play_session_test
