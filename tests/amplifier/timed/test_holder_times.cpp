// SPDX-License-Identifier: MIT
// Latency of switching off, and beats that keep the line on: real processes, real time and the shipped
// limits. The line's own records are measured.
#include <csignal>

#include <poll.h>

#include <doctest/doctest.h>

#include "fake_line.hpp"

namespace holder_times_test {

using namespace tactor;
using namespace tactor::test;

namespace {

constexpr amplifier::holder_limits shipped;

void check_off(const fake_line& line, std::int64_t since_ns, std::int64_t within_ms)
{
    const auto s = line.next();
    REQUIRE(s.has_value());
    CHECK(!s->on);
    CHECK((s->time_ns - since_ns) / 1'000'000 < within_ms);
}

} // namespace

TEST_CASE("a line that is off needs no beats, one that is on does")
{
    fake_line line;
    const auto h = amplifier::start_holder(line.held(), [] { return false; });
    CHECK(!line.next(2 * shipped.silence_ms).has_value());
    CHECK(h->beat());
    CHECK(h->set(true));
    REQUIRE(line.next().has_value());
    std::int64_t last = now_ns();
    for (int i = 0; i < 10; ++i) {
        last = now_ns();
        CHECK(h->beat());
        CHECK(!line.next(50).has_value());
    }
    const std::int64_t after = now_ns();
    const auto s = line.next();
    REQUIRE(s.has_value());
    CHECK(!s->on);
    CHECK((s->time_ns - last) / 1'000'000 >= shipped.silence_ms - 1);
    CHECK((s->time_ns - after) / 1'000'000 < promised_ms(h->pid()));
}

TEST_CASE("a player killed in any way leaves the line off soon")
{
    for (const int number : {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGABRT, SIGSEGV}) {
        CAPTURE(number);
        fake_line line;
        const player p(line, shipped, keep_beating);
        const std::int64_t limit = promised_ms(p.holder());
        check_off(line, p.signal(number), limit);
    }
}

TEST_CASE("a player that is stopped leaves the line off, learns of it, and may switch on again")
{
    fake_line line;
    const player p(line, shipped, [](amplifier::holder_link& h, const std::function<void(int)>& tell) {
        while (h.beat())
            ::poll(nullptr, 0, 50);
        tell(h.beat() ? 1 : 0);
        h.set(true);
        tell(h.beat() ? 1 : 0);
        keep_beating(h, tell);
    });
    const std::int64_t limit = promised_ms(p.holder());
    check_off(line, p.signal(SIGSTOP), limit);
    CHECK(!line.next(200).has_value());
    p.signal(SIGCONT);
    CHECK(p.told() == 0);
    const auto again = line.next();
    REQUIRE(again.has_value());
    CHECK(again->on);
    CHECK(p.told() == 1);
    check_off(line, p.signal(SIGKILL), limit);
}

} // namespace holder_times_test
