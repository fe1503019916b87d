// SPDX-License-Identifier: MIT
// Lines and the amplifier against a real kernel: hw FOLDER [doctest options], where FOLDER is that of a
// gpio-sim chip with at least 6 lines, not used before, of which line 2 has a name. Needs root.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <poll.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <tactor/error.hpp>
#include <tactor/lines.hpp>

#include "../../support/count_allocations.hpp"
#include "../fake_line.hpp"
#include "amplifier/line.hpp"
#include "core/owned.hpp"

namespace hw_test {

using namespace tactor;
using namespace tactor::test;

namespace {

/// The other side of a gpio-sim chip, in place of the hardware.
class sim_chip {
public:
    /// `folder`: /sys/devices/platform/<device>/<chip>.
    explicit sim_chip(const std::string& folder) : folder_(folder)
    {
        while (folder_.ends_with('/'))
            folder_.pop_back();
    }

    /// /dev/gpiochipN
    std::string path() const { return "/dev/" + folder_.substr(folder_.rfind('/') + 1); }
    /// Returns the driven value of an output, or the pull of an input.
    int value(unsigned line) const
    {
        std::ifstream in(folder_ + "/sim_gpio" + std::to_string(line) + "/value");
        int v = -1;
        in >> v;
        return v;
    }
    /// Pulls an input up or down, like a button.
    void pull(unsigned line, bool up) const
    {
        std::ofstream out(folder_ + "/sim_gpio" + std::to_string(line) + "/pull");
        out << (up ? "pull-up" : "pull-down") << std::flush;
        if (!out)
            throw std::runtime_error("cannot pull line " + std::to_string(line));
    }
    /// Polls a line; returns the CLOCK_MONOTONIC time in ns at which it was first low.
    std::optional<std::int64_t> low_at(unsigned line, std::int64_t within_ms) const
    {
        const std::int64_t until = now_ns() + within_ms * 1'000'000;
        while (now_ns() < until) {
            if (value(line) == 0)
                return now_ns();
            ::sched_yield();
        }
        return std::nullopt;
    }

private:
    std::string folder_;
};

std::unique_ptr<sim_chip> the_chip;

const sim_chip& chip()
{
    return *the_chip;
}

gpio_chip_info listed()
{
    for (const gpio_chip_info& c : list_gpio())
        if (c.path == chip().path())
            return c;
    FAIL("the chip is not listed");
    return {};
}

gpio_line_name at(unsigned offset)
{
    return {.chip = chip().path(), .offset = offset};
}

std::string complaint(const gpio_line_name& l)
{
    try {
        static_cast<void>(open_output(l));
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::not_available);
        return e.what();
    }
    return "no error";
}

bool waits(const edge_input& in, int timeout_ms)
{
    pollfd p{in.descriptor(), POLLIN, 0};
    return ::poll(&p, 1, timeout_ms) > 0;
}

constexpr unsigned amplifier_line = 3;
constexpr std::int64_t promised_off_ms = 200;

amplifier_settings amplifier(bool active_low = false)
{
    amplifier_settings s;
    s.line = {.chip = chip().path(), .offset = amplifier_line};
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

TEST_CASE("the list shows labels, names, directions and consumers")
{
    const gpio_chip_info before = listed();
    CHECK(before.error.empty());
    CHECK(before.label.size() > 0);
    CHECK("/dev/" + before.name == before.path);
    REQUIRE(before.lines.size() >= 6);
    CHECK(!before.lines[2].name.empty());
    CHECK(before.lines[0].name.empty());
    CHECK(before.lines[0].consumer.empty());
    CHECK(!before.lines[0].output);
    const auto line = open_output(at(0));
    CHECK(listed().lines[0].consumer == "tactor");
    CHECK(listed().lines[0].output);
}

TEST_CASE("a chip is found by path and label, a line by offset and name")
{
    const gpio_chip_info c = listed();
    for (const gpio_line_name& l :
         {at(2), gpio_line_name{.chip = c.label, .offset = 2}, gpio_line_name{.name = c.lines[2].name},
          gpio_line_name{.chip = c.label, .name = c.lines[2].name}}) {
        const auto line = open_output(l);
        CHECK(line->set(true));
        CHECK(chip().value(2) == 1);
    }
}

TEST_CASE("an output starts off, follows, and is off when it is given up")
{
    auto line = open_output(at(3));
    CHECK(chip().value(3) == 0);
    for (int i = 0; i < 20; ++i) {
        CHECK(line->set(i % 2 == 0));
        CHECK(chip().value(3) == (i % 2 == 0 ? 1 : 0));
    }
    CHECK(line->set(true));
    line.reset();
    CHECK(chip().value(3) == 0);
    CHECK(listed().lines[3].consumer.empty());
}

TEST_CASE("off is high on a line that is active low")
{
    chip().pull(3, false);
    auto line = open_output(at(3), true);
    CHECK(chip().value(3) == 1);
    CHECK(line->set(true));
    CHECK(chip().value(3) == 0);
    CHECK(line->set(false));
    CHECK(chip().value(3) == 1);
}

TEST_CASE("switching does not touch the heap")
{
    const auto line = open_output(at(3));
    const auto in = open_edges(at(4), edge_kind::both, 0.0);
    chip().pull(4, true);
    REQUIRE(waits(*in, 5000));
    std::uint64_t calls = 0;
    bool fine = true;
    {
        const count_allocations count;
        for (int i = 0; i < 100; ++i)
            fine = line->set(i % 2 == 0) && fine;
        fine = in->read().has_value() && !in->read() && fine;
        calls = count.calls();
    }
    CHECK(fine);
    CHECK(calls == 0);
    chip().pull(4, false);
}

TEST_CASE("the request's descriptor is known, so that the holder can keep it alone")
{
    const auto other = amplifier::request_output({chip().path(), 4, false});
    const auto r = amplifier::request_output({chip().path(), 3, false});
    REQUIRE(r.line);
    REQUIRE(other.line);
    CHECK(r.line->descriptor() >= 0);
    CHECK(r.line->descriptor() != other.line->descriptor());
}

TEST_CASE("a busy line is named with its holder")
{
    const auto line = open_output(at(3));
    CHECK(complaint(at(3)) ==
          "GPIO line 3 of " + chip().path() + ": busy: another tactor holds it (stop that tactor first)");
}

TEST_CASE("a user who may not open the chip gets that reason")
{
    int ends[2] = {-1, -1};
    REQUIRE(::pipe(ends) == 0);
    const pid_t child = ::fork();
    if (child == 0) {
        die_quietly();
        const bool dropped = ::setgid(65534) == 0 && ::setuid(65534) == 0;
        const std::string text = dropped ? complaint(at(3)) + "|" + listed().error : "still root";
        ::_exit(::write(ends[1], text.data(), text.size()) > 0 ? 0 : 1);
    }
    ::close(ends[1]);
    std::string text(1000, ' ');
    const ssize_t n = ::read(ends[0], text.data(), text.size());
    ::close(ends[0]);
    ::waitpid(child, nullptr, 0);
    text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    const std::string why = "no permission to open " + chip().path() + " (";
    CHECK(text.starts_with("GPIO line 3 of " + chip().path() + ": " + why));
    CHECK(text.find("|" + why) != std::string::npos);
    CHECK(text.find("sudo usermod -aG ") != std::string::npos);
}

TEST_CASE("an offset beyond the chip and a missing label are errors")
{
    CHECK(complaint(at(1000)).find("no line 1000") != std::string::npos);
    CHECK(complaint({.chip = "no such label", .offset = 1}).find(listed().label) != std::string::npos);
    CHECK(complaint({.name = "no such line"}).find("no line has this name") != std::string::npos);
    CHECK(complaint({.chip = "/dev/gpiochip999", .offset = 1}).find("there is no /dev/gpiochip999") !=
          std::string::npos);
}

TEST_CASE("pulls arrive as edges, stamped by the kernel in CLOCK_MONOTONIC")
{
    chip().pull(5, false);
    const auto in = open_edges(at(5), edge_kind::both, 0.0);
    CHECK(!in->read());
    CHECK(!waits(*in, 0));
    for (const bool up : {true, false, true, false}) {
        const std::int64_t before = now_ns();
        chip().pull(5, up);
        REQUIRE(waits(*in, 5000));
        const auto e = in->read();
        const std::int64_t after = now_ns();
        REQUIRE(e.has_value());
        CHECK(e->rising == up);
        CHECK(e->time_ns >= before);
        CHECK(e->time_ns <= after);
        CHECK(!in->read());
    }
}

TEST_CASE("waiting edges keep the descriptor readable and come in order")
{
    chip().pull(5, false);
    const auto in = open_edges(at(5), edge_kind::both, 0.0);
    // Pulls without a pause would be one interrupt.
    chip().pull(5, true);
    REQUIRE(waits(*in, 5000));
    chip().pull(5, false);
    const auto first = in->read();
    REQUIRE(waits(*in, 5000));
    chip().pull(5, true);
    const auto second = in->read();
    REQUIRE(waits(*in, 5000));
    const auto third = in->read();
    REQUIRE((first && second && third));
    CHECK(first->rising);
    CHECK(!second->rising);
    CHECK(third->rising);
    CHECK(first->time_ns < second->time_ns);
    CHECK(second->time_ns < third->time_ns);
    CHECK(!waits(*in, 0));
    CHECK(!in->read());
}

TEST_CASE("only the requested edges arrive, and a burst counts once")
{
    for (const bool rising : {true, false}) {
        chip().pull(5, false);
        const auto in = open_edges(at(5), rising ? edge_kind::rising : edge_kind::falling, 10.0);
        for (int i = 0; i < 5; ++i) {
            chip().pull(5, true);
            chip().pull(5, false);
        }
        REQUIRE(waits(*in, 5000));
        const auto first = in->read();
        REQUIRE(first.has_value());
        CHECK(first->rising == rising);
        waits(*in, 100); // bounces
        CHECK(!in->read());
        CHECK(!in->read());
    }
}

TEST_CASE("pull resistors are set on request")
{
    {
        const auto in = open_edges(at(5), edge_kind::both, 0.001, pull_kind::up);
        CHECK(chip().value(5) == 1);
    }
    const auto in = open_edges(at(5), edge_kind::both, 0.001, pull_kind::down);
    CHECK(chip().value(5) == 0);
}

TEST_CASE("the amplifier is off by default, follows, and is free again at once")
{
    for (int i = 0; i < 5; ++i) {
        auto amp = open_amplifier(amplifier());
        CHECK(chip().value(amplifier_line) == 0);
        CHECK(amp->set(true));
        CHECK(chip().value(amplifier_line) == 1);
        CHECK(amp->set(false));
        CHECK(chip().value(amplifier_line) == 0);
        CHECK(amp->set(true));
        amp.reset();
        CHECK(chip().value(amplifier_line) == 0);
    }
}

TEST_CASE("an amplifier that is active low is off when the line is high")
{
    auto amp = open_amplifier(amplifier(true));
    CHECK(chip().value(amplifier_line) == 1);
    CHECK(amp->set(true));
    CHECK(chip().value(amplifier_line) == 0);
    CHECK(amp->set(false));
    CHECK(chip().value(amplifier_line) == 1);
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
            CHECK(chip().value(amplifier_line) == 1);
            const std::int64_t since = now_ns();
            ::kill(p.pid(), number);
            const auto off = chip().low_at(amplifier_line, 2000);
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
    const detail::owned_fd end = open_pidfd(holder);
    ::kill(holder, SIGKILL);
    CHECK(ends(end));
    CHECK(!amp->beat());
    CHECK(chip().value(amplifier_line) == 0);
    CHECK(amp->set(false));
}

} // namespace hw_test

int main(int argc, char** argv)
{
    if (argc < 2 || argv[1][0] == '-') {
        std::fputs("usage: hw /sys/devices/platform/gpio-sim.N/gpiochipM [doctest options]\n", stderr);
        return 2;
    }
    hw_test::the_chip = std::make_unique<hw_test::sim_chip>(argv[1]);
    if (hw_test::chip().value(0) < 0) {
        std::fprintf(stderr, "hw: %s is not the folder of a gpio-sim chip\n", argv[1]);
        return 2;
    }
    doctest::Context context(argc - 1, argv + 1);
    return context.run();
}
