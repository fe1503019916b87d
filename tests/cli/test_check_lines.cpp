// SPDX-License-Identifier: MIT
// GPIO lines as `check` sees them, and how findings are printed.

#include <doctest/doctest.h>

#include "cli/check/check.hpp"

namespace check_lines_test {

using namespace tactor;
using namespace tactor::cli;

namespace {

setup wired(bool active_low = false)
{
    setup s;
    s.amplifier = amplifier_settings{.line = {.name = "AMP"}, .active_low = active_low};
    s.sync.emplace();
    s.sync->out = gpio_line_name{.name = "OUT"};
    s.sync->in = gpio_line_name{.name = "GONE"};
    return s;
}

gpio_line_place find(const gpio_line_name& l)
{
    if (l.name == "GONE")
        throw error(error_kind::not_available, "GPIO line \"GONE\"", "no line has this name",
                    "there are: AMP, OUT");
    const bool amplifier = l.name == "AMP";
    return {"/dev/gpiochip0",
            "pinctrl-rp1",
            {.offset = amplifier ? 17U : 27U, .name = l.name, .consumer = amplifier ? "" : "led"}};
}

} // namespace

TEST_CASE("lines are free, held or not there")
{
    const auto all = check_lines(wired(), true, find);
    REQUIRE(all.size() == 3);
    CHECK(all[0].check == "amplifier");
    CHECK(all[0].how == level::ok);
    CHECK(all[0].found == "line 17 \"AMP\" of pinctrl-rp1 (/dev/gpiochip0), free");
    CHECK(all[1].how == level::error);
    CHECK(all[1].kind == error_kind::not_available);
    CHECK(all[1].found == "line 27 \"OUT\" of pinctrl-rp1 (/dev/gpiochip0): held by \"led\"");
    CHECK(all[2].found == "GPIO line \"GONE\": no line has this name");
    CHECK(all[2].cure == "there are: AMP, OUT");
    CHECK(worst_status(all) == 3);
}

TEST_CASE("an amplifier that is on when low is a warning, and so is none where a person feels it")
{
    CHECK(check_lines(wired(true), true, find)[0].how == level::warning);
    for (const bool felt : {true, false}) {
        const auto none = check_lines({}, felt, find);
        REQUIRE(none.size() == 1);
        CHECK(none[0].how == (felt ? level::warning : level::ok));
        CHECK(none[0].cure.find("tactor-raspberry-pi(7)") != std::string::npos);
    }
}

TEST_CASE("bad input wins over a missing device in the exit status, warnings do not count")
{
    const finding device = failure("device", error(error_kind::not_available, "a", "b"));
    const finding input = failure("levels", error(error_kind::bad_input, "a", "b"));
    const finding other = failure("x", error(error_kind::runtime, "a", "b"));
    CHECK(worst_status({}) == 0);
    CHECK(worst_status({warning("a", "b", "c"), fine("a", "b")}) == 0);
    CHECK(worst_status({device, input}) == 2);
    CHECK(worst_status({other, device}) == 3);
    CHECK(worst_status({other}) == 1);
}

TEST_CASE("findings have this form")
{
    const std::vector<finding> all{
        fine("array", "palm-3x3: 9 tactors"),
        warning("sound servers", "pipewire (process 812): may take card Tactor at any time",
                "call the card Tactor"),
        failure("device", error(error_kind::not_available, "PCM \"x\"", "no such PCM", "try y"))};
    CHECK(check_text(all, false) ==
          "ok       array          palm-3x3: 9 tactors\n"
          "warning  sound servers  pipewire (process 812): may take card Tactor at any\n"
          "                        time\n"
          "                        -> call the card Tactor\n"
          "error    device         PCM \"x\": no such PCM\n"
          "                        -> try y\n"
          "\n1 error, 1 warning, 1 ok\n");
    CHECK(check_text(all, true).find("palm-3x3") == std::string::npos);
    CHECK(check_text({fine("a", "b")}, true) == "0 errors, 0 warnings, 1 ok\n");
}

} // namespace check_lines_test
