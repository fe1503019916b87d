// SPDX-License-Identifier: MIT
// Outputs and inputs through the kernel.
#include <string>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/lines.hpp>

#include "../../support/count_allocations.hpp"
#include "../fake_line.hpp"
#include "amplifier/line.hpp"
#include "sim.hpp"

namespace hw_lines_test {

using namespace tactor;
using namespace tactor::test;

namespace {

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
          "GPIO line 3 of " + chip().path() + ": busy: another tactor holds it (stop that one first)");
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

} // namespace hw_lines_test
