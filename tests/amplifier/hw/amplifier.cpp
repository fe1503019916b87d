// SPDX-License-Identifier: MIT
// The amplifier's line and the end of its player, through the kernel.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/lines.hpp>

#include "../fake_line.hpp"
#include "sim.hpp"

namespace hw_amplifier_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr unsigned line = 3;
constexpr std::int64_t promised_off_ms = 200;

amplifier_settings amplifier(bool active_low = false)
{
    amplifier_settings s;
    s.line = {.chip = chip().path(), .offset = line};
    s.active_low = active_low;
    return s;
}

/// A process that has the amplifier on and beats.
class process {
public:
    explicit process(bool active_low = false)
    {
        int ends[2] = {-1, -1};
        REQUIRE(::pipe(ends) == 0);
        pid_ = ::fork();
        if (pid_ == 0)
            play(active_low, ends[1]);
        ::close(ends[1]);
        char x = 0;
        REQUIRE(::read(ends[0], &x, 1) == 1);
        ::close(ends[0]);
    }
    ~process()
    {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    process(const process&) = delete;
    process& operator=(const process&) = delete;
    pid_t pid() const { return pid_; }

private:
    [[noreturn]] static void play(bool active_low, int tell) noexcept
    {
        die_quietly();
        const auto amp = open_amplifier(amplifier(active_low));
        if (!amp->set(true) || ::write(tell, "x", 1) != 1)
            ::_exit(1);
        while (amp->beat())
            ::poll(nullptr, 0, 50);
        ::_exit(2);
    }

    pid_t pid_ = -1;
};

/// Waits until the line is free: that is some time after the holder switched it off.
std::unique_ptr<enable_line> open_when_free()
{
    const std::int64_t until = now_ns() + 5'000'000'000;
    for (;;) {
        try {
            return open_amplifier(amplifier());
        } catch (const error&) {
            if (now_ns() > until)
                throw;
        }
    }
}

} // namespace

TEST_CASE("the amplifier is off by default, follows, and is free again at once")
{
    for (int i = 0; i < 5; ++i) {
        auto amp = open_amplifier(amplifier());
        CHECK(chip().value(line) == 0);
        CHECK(amp->set(true));
        CHECK(chip().value(line) == 1);
        CHECK(amp->set(false));
        CHECK(chip().value(line) == 0);
        CHECK(amp->set(true));
        amp.reset();
        CHECK(chip().value(line) == 0);
    }
}

TEST_CASE("an amplifier that is active low is off when the line is high")
{
    auto amp = open_amplifier(amplifier(true));
    CHECK(chip().value(line) == 1);
    CHECK(amp->set(true));
    CHECK(chip().value(line) == 0);
    CHECK(amp->set(false));
    CHECK(chip().value(line) == 1);
}

TEST_CASE("the player keeps no copy of the line, and the holder none of the player's other lines")
{
    auto sync = open_output({.chip = chip().path(), .offset = 1});
    const auto amp = open_amplifier(amplifier());
    sync.reset();
    CHECK_NOTHROW(open_output({.chip = chip().path(), .offset = 1}));
    CHECK_THROWS_AS(open_amplifier(amplifier()), error);
}

// Reading the line takes time itself: the numbers are upper bounds.
TEST_CASE("the line is off within 200 ms of the player's end or stop")
{
    for (const int number : {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGSTOP}) {
        CAPTURE(number);
        std::int64_t worst = 0;
        for (int i = 0; i < 5; ++i) {
            const process p;
            CHECK(chip().value(line) == 1);
            const std::int64_t since = now_ns();
            ::kill(p.pid(), number);
            const auto off = chip().low_at(line, 2000);
            REQUIRE(off.has_value());
            worst = std::max(worst, *off - since);
            ::kill(p.pid(), SIGKILL); // the stopped one, whose holder would keep the line
            CHECK(open_when_free()->set(false));
        }
        std::printf("signal %d: off within %.1f ms (largest of 5)\n", number,
                    static_cast<double>(worst) / 1e6);
        CHECK(worst < promised_off_ms * 1'000'000);
    }
}

TEST_CASE("a killed holder leaves the line to the player, which switches it off")
{
    amplifier_settings s = amplifier();
    const auto amp = open_amplifier(s);
    CHECK(amp->set(true));
    const pid_t holder = dynamic_cast<amplifier::holder_link&>(*amp).pid();
    const int end = open_pidfd(holder);
    ::kill(holder, SIGKILL);
    CHECK(ends(end));
    ::close(end);
    CHECK(!amp->beat());
    CHECK(chip().value(line) == 0);
    CHECK(amp->set(false));
}

} // namespace hw_amplifier_test
