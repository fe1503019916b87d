// SPDX-License-Identifier: MIT
// The chips of a machine without any, and folders that look like /dev.
#include "amplifier/chips.hpp"

#include <cerrno>
#include <filesystem>
#include <string>

#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

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
    CHECK(tactor::amplifier::chip_paths(f.path()) ==
          std::vector{at("gpiochip0"), at("gpiochip2"), at("gpiochip10")});
    CHECK(tactor::amplifier::chip_paths(f / "nowhere").empty());
}

TEST_CASE("a file's group has a name, a missing file's is the usual one")
{
    CHECK(tactor::amplifier::find_group("/dev/null") == "root");
    CHECK(tactor::amplifier::find_group("/nowhere") == "gpio");
}

TEST_CASE("a file that is no GPIO chip is not opened")
{
    const folder f;
    f.write("gpiochip0");
    for (const std::string& path :
         {(f / "gpiochip0").string(), std::string("/dev/null"), f.path().string()}) {
        const tactor::amplifier::chip c = tactor::amplifier::read_chip(path);
        CHECK(c.code != 0);
        CHECK(c.info.path == path);
        CHECK(c.info.lines.empty());
    }
    CHECK(tactor::amplifier::read_chip("/nowhere").code == ENOENT);
}

TEST_CASE("a pipe, file or socket named as a chip is never opened")
{
    const folder f;
    f.write("file");
    REQUIRE(::mkfifo((f / "pipe").c_str(), 0600) == 0);
    REQUIRE(::mknod((f / "socket").c_str(), S_IFSOCK | 0600, 0) == 0);
    const int watch = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    REQUIRE(watch >= 0);
    for (const char* name : {"file", "pipe", "socket"})
        REQUIRE(::inotify_add_watch(watch, (f / name).c_str(), IN_OPEN) >= 0);
    for (const char* name : {"file", "pipe", "socket"}) {
        CAPTURE(name);
        const std::string path = (f / name).string();
        CHECK(tactor::amplifier::not_a_chip(path) == ENOTTY);
        std::string said;
        try {
            static_cast<void>(tactor::find_gpio_line({.chip = path, .offset = 0}));
        } catch (const tactor::error& e) {
            said = e.what();
        }
        CHECK(said.find("is not a GPIO chip") != std::string::npos);
    }
    char event[512];
    CHECK(::read(watch, event, sizeof event) == -1);
    CHECK(errno == EAGAIN);
    ::close(watch);
}

TEST_CASE("a path that is no GPIO chip is an error that says so")
{
    const tactor::gpio_line_name l{.chip = "/dev/null", .offset = 3};
    std::string text;
    try {
        static_cast<void>(tactor::open_output(l));
    } catch (const tactor::error& e) {
        CHECK(e.kind() == tactor::error_kind::not_available);
        text = e.what();
    }
    CHECK(text.starts_with("GPIO line 3 of /dev/null: /dev/null is not a GPIO chip"));
    CHECK(text.ends_with("(tactor devices lists the chips)"));
}

} // namespace chips_test
