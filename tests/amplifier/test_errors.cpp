// SPDX-License-Identifier: MIT
// Messages for the kernel's refusals.
#include "amplifier/errors.hpp"

#include <cerrno>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace errors_test {

using namespace tactor;

namespace {

std::string refusal(int code, const std::string& holder)
{
    gpio_line_name l{.chip = "pinctrl-rp1", .offset = 17};
    l.where = {"palm.toml", 12, 1};
    const error e = amplifier::request_error(l, code, holder);
    CHECK(e.kind() == error_kind::not_available);
    return e.what();
}

template <typename F>
std::string complaint(F f)
{
    try {
        f();
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        return e.what();
    }
    return "no error";
}

} // namespace

TEST_CASE("a busy line is named with its holder")
{
    CHECK(refusal(EBUSY, "gpiomon") == "palm.toml:12:1: GPIO line 17 of pinctrl-rp1: busy: \"gpiomon\" holds "
                                       "it (stop that program, or choose another line)");
    CHECK(refusal(EBUSY, "tactor") ==
          "palm.toml:12:1: GPIO line 17 of pinctrl-rp1: busy: another tactor holds it (stop that one first)");
    CHECK(refusal(EBUSY, amplifier::nameless_consumer) ==
          "palm.toml:12:1: GPIO line 17 of pinctrl-rp1: busy: the kernel holds it (a driver or overlay uses "
          "the pin; choose another line)");
    CHECK(refusal(EBUSY, "").find("busy: the kernel holds it") != std::string::npos);
}

TEST_CASE("a missing ability of the chip is reported as such")
{
    CHECK(refusal(ENOTSUP, "").find("the chip cannot do this with the line: ") != std::string::npos);
    CHECK(refusal(EPERM, "").find("the kernel does not permit this use of the line") != std::string::npos);
    CHECK(refusal(EIO, "").find("the line cannot be had: ") != std::string::npos);
}

TEST_CASE("a listed chip that cannot be opened has a hint")
{
    amplifier::chip c;
    c.info.path = "/dev/gpiochip0";
    c.code = EACCES;
    c.group = "gpio";
    CHECK(amplifier::advice(c) ==
          "no permission to open /dev/gpiochip0 (sudo usermod -aG gpio $USER, then log in again)");
}

TEST_CASE("impossible times are refused before any device is touched")
{
    const gpio_line_name l{.name = "no such line"};
    for (const double s :
         {-0.001, 10.001, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        CHECK(complaint([&] {
                  static_cast<void>(open_edges(l, edge_kind::rising, s));
              }).find("a debounce time of") != std::string::npos);
}

} // namespace errors_test
