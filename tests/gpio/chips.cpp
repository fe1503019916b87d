// SPDX-License-Identifier: MIT
// The chips of a machine that has none, and folders that look like /dev.
#include "gpio/chips.hpp"

#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "folder.hpp"

namespace chips_test {

namespace fs = std::filesystem;

TEST_CASE("chips are listed by number, each once")
{
    const folder f;
    for (const char* name :
         {"gpiochip10", "gpiochip2", "gpiochip0", "gpiochip", "gpiochip1x", "gpiomem", "mygpiochip1"})
        f.write(name);
    fs::create_symlink("gpiochip0", f / "gpiochip4");
    const auto at = [&](const char* name) { return (f / name).string(); };
    CHECK(tactor::gpio::chip_paths(f.path()) ==
          std::vector{at("gpiochip0"), at("gpiochip2"), at("gpiochip10")});
    CHECK(tactor::gpio::chip_paths(f / "nowhere").empty());
}

TEST_CASE("a file's group has a name, a missing file's is the usual one")
{
    CHECK(tactor::gpio::group_of("/dev/null") == "root");
    CHECK(tactor::gpio::group_of("/nowhere") == "gpio");
}

TEST_CASE("what is no GPIO chip is not opened as one")
{
    const folder f;
    f.write("gpiochip0");
    for (const std::string& path :
         {(f / "gpiochip0").string(), std::string("/dev/null"), f.path().string()}) {
        const tactor::gpio::chip c = tactor::gpio::read_chip(path);
        CHECK(c.code != 0);
        CHECK(c.info.path == path);
        CHECK(c.info.lines.empty());
    }
    CHECK(tactor::gpio::read_chip("/nowhere").code == ENOENT);
}

TEST_CASE("a path that is no GPIO chip is an error that says so")
{
    const tactor::gpio_line_name l{.chip = "/dev/null", .offset = 3};
    std::string text;
    try {
        tactor::open_output(l);
    } catch (const tactor::error& e) {
        CHECK(e.kind() == tactor::errc::not_available);
        text = e.what();
    }
    CHECK(text.starts_with("GPIO line 3 of /dev/null: /dev/null is not a GPIO chip"));
    CHECK(text.ends_with("(tactor devices lists the chips)"));
}

} // namespace chips_test
