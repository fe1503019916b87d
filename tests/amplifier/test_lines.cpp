// SPDX-License-Identifier: MIT
// Chips and lines: the list, the search for the user's line, messages for what the kernel refuses, and
// bounce.
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <doctest/doctest.h>

#include <tactor/error.hpp>
#include <tactor/lines.hpp>

#include "amplifier/chips.hpp"
#include "amplifier/line.hpp"
#include "folder.hpp"
#include "has.hpp"

namespace lines_test {

using namespace tactor;
using amplifier::chip;
using amplifier::find_line;

namespace fs = std::filesystem;

namespace {

chip make_chip(unsigned number, const std::string& label, const std::vector<std::string>& names)
{
    chip c;
    c.info.name = "gpiochip" + std::to_string(number);
    c.info.path = "/dev/" + c.info.name;
    c.info.label = label;
    for (const std::string& n : names)
        c.info.lines.push_back({.offset = static_cast<unsigned>(c.info.lines.size()), .name = n});
    return c;
}

chip shut_chip(unsigned number, int code, const std::string& group)
{
    chip c = make_chip(number, "", {});
    c.code = code;
    c.group = group;
    return c;
}

const std::vector<chip> pi{make_chip(0, "pinctrl-rp1", {"ID_SD", "GPIO1", "GPIO17", "", "LED"}),
                           make_chip(10, "gpio-brcmstb@0", {"LED", "FAN"}), make_chip(11, "empty", {})};

gpio_line_name by_chip(const std::string& name, unsigned offset)
{
    return {.chip = name, .offset = offset};
}

gpio_line_name by_name(const std::string& name, const std::string& on = {})
{
    return {.chip = on, .name = name};
}

// Returns the message of a call's error, which is of this kind; "" for none.
template <typename Call>
std::string complaint(Call call, error_kind kind = error_kind::not_available)
{
    try {
        call();
    } catch (const error& e) {
        CHECK(e.kind() == kind);
        return e.what();
    }
    return {};
}

std::string complaint(const std::vector<chip>& chips, const gpio_line_name& wanted,
                      error_kind kind = error_kind::not_available)
{
    return complaint([&] { return find_line(chips, wanted); }, kind);
}

std::string refusal(int code, const std::string& holder)
{
    gpio_line_name l{.chip = "pinctrl-rp1", .offset = 17};
    l.where = {"palm.toml", 12, 1};
    const error e = amplifier::request_error(l, code, holder);
    CHECK(e.kind() == error_kind::not_available);
    return e.what();
}

std::vector<bool> filter(std::int64_t window, const std::vector<std::int64_t>& times)
{
    amplifier::debounce d(window);
    std::vector<bool> out;
    for (const std::int64_t t : times)
        out.push_back(d.accepts(t));
    return out;
}

} // namespace

TEST_CASE("a chip is found by label and by path, a line by offset and by name")
{
    struct row {
        gpio_line_name wanted;
        std::size_t chip;
        unsigned offset;
    };
    const std::vector<row> rows{
        {by_chip("pinctrl-rp1", 0), 0, 0},
        {by_chip("pinctrl-rp1", 4), 0, 4},
        {by_chip("/dev/gpiochip10", 1), 1, 1},
        {by_name("GPIO17"), 0, 2},
        {by_name("FAN"), 1, 1},
        {by_name("LED", "gpio-brcmstb@0"), 1, 0},
        {by_name("LED", "/dev/gpiochip0"), 0, 4},
    };
    for (const row& r : rows) {
        CAPTURE(r.wanted.chip);
        CAPTURE(r.wanted.name);
        const auto found = find_line(pi, r.wanted);
        CHECK(found.chip == r.chip);
        CHECK(found.offset == r.offset);
    }
}

TEST_CASE("a missing line is refused with the existing ones")
{
    CHECK(
        complaint(pi, by_chip("pinctrl-bcm2711", 17)) ==
        "GPIO line 17 of pinctrl-bcm2711: no chip labelled \"pinctrl-bcm2711\" (use one of: \"pinctrl-rp1\" "
        "at /dev/gpiochip0, \"gpio-brcmstb@0\" at /dev/gpiochip10, \"empty\" at /dev/gpiochip11)");
    CHECK(complaint(pi, by_chip("/dev/gpiochip4", 17)) ==
          "GPIO line 17 of /dev/gpiochip4: there is no /dev/gpiochip4 (use one of: \"pinctrl-rp1\" at "
          "/dev/gpiochip0, \"gpio-brcmstb@0\" at /dev/gpiochip10, \"empty\" at /dev/gpiochip11)");
    CHECK(complaint(pi, by_chip("pinctrl-rp1", 5)) ==
          "GPIO line 5 of pinctrl-rp1: chip \"pinctrl-rp1\" at /dev/gpiochip0 has lines 0 to 4, no line 5 "
          "(count the lines of the chip from 0)");
    CHECK(complaint(pi, by_chip("empty", 0)) == "GPIO line 0 of empty: chip \"empty\" at /dev/gpiochip11 has "
                                                "no lines (count the lines of the chip from 0)");
    CHECK(complaint(pi, by_name("GPI017")) ==
          "GPIO line \"GPI017\": no line has this name (did you mean \"GPIO17\"?)");
    CHECK(complaint(pi, by_name("AMPLIFIER")) ==
          "GPIO line \"AMPLIFIER\": no line has this name (use one of: ID_SD, GPIO1, GPIO17, LED, LED, FAN)");
    CHECK(complaint(pi, by_name("FAN", "pinctrl-rp1")) ==
          "GPIO line \"FAN\": no line of pinctrl-rp1 has this name (use one of: ID_SD, GPIO1, GPIO17, LED)");
    CHECK(complaint({make_chip(0, "sim", {"", ""})}, by_name("GPIO17")) ==
          "GPIO line \"GPIO17\": no line has this name (give chip and offset: no line of this machine has a "
          "name)");
    CHECK(complaint({}, by_name("GPIO17")) == "GPIO line \"GPIO17\": there is no GPIO chip on this machine "
                                              "(load the driver of a GPIO chip, or give "
                                              "/dev/gpiochip* to the container)");
}

TEST_CASE("a chip's number is no name for it, since it changes")
{
    CHECK(complaint(pi, by_chip("gpiochip0", 17)) ==
          "GPIO line 17 of gpiochip0: the kernel may change the number \"gpiochip0\" at each start (use the "
          "label, chip = \"pinctrl-rp1\", or the path /dev/gpiochip0)");
    CHECK(complaint({shut_chip(0, EACCES, "gpio")}, by_chip("gpiochip0", 17)) ==
          "GPIO line 17 of gpiochip0: the kernel may change the number \"gpiochip0\" at each start (use the "
          "chip's label, or the path /dev/gpiochip0)");
    // Unless it is a label.
    CHECK(find_line(std::vector{make_chip(3, "gpiochip0", {"", ""})}, by_chip("gpiochip0", 1)).offset == 1);
}

TEST_CASE("ambiguous names are refused")
{
    CHECK(complaint(pi, by_name("LED")) ==
          "GPIO line \"LED\": 2 lines have this name: line 4 of /dev/gpiochip0, line 0 of /dev/gpiochip10 "
          "(select one by chip and offset)");
    const std::vector<chip> twins{make_chip(0, "ftdi", {"a"}), make_chip(1, "ftdi", {"b"})};
    CHECK(complaint(twins, by_chip("ftdi", 0)) ==
          "GPIO line 0 of ftdi: 2 chips are labelled \"ftdi\": /dev/gpiochip0, /dev/gpiochip1 (name the chip "
          "by its path)");
    CHECK(find_line(twins, by_chip("/dev/gpiochip1", 0)).chip == 1);
}

TEST_CASE("a chip that may not be opened is named with the group to join")
{
    const std::string shut = "GPIO line 17 of pinctrl-rp1: no permission to open /dev/gpiochip0 (sudo "
                             "usermod -aG gpio $USER, then log in again)";
    CHECK(complaint({shut_chip(0, EACCES, "gpio")}, by_chip("pinctrl-rp1", 17)) == shut);
    CHECK(complaint({make_chip(1, "other", {"x"}), shut_chip(0, EACCES, "gpio")},
                    by_chip("pinctrl-rp1", 17)) == shut);
    CHECK(complaint({shut_chip(0, EPERM, "dialout")}, by_chip("/dev/gpiochip0", 17)) ==
          "GPIO line 17 of /dev/gpiochip0: no permission to open /dev/gpiochip0 (sudo usermod -aG dialout "
          "$USER, then log in again)");
    CHECK(complaint({shut_chip(0, EACCES, "root")}, by_name("GPIO17")) ==
          "GPIO line \"GPIO17\": no permission to open /dev/gpiochip0 (only root may open the device: sudo "
          "groupadd --system --force gpio, install the udev rules, which give the device to that group, then "
          "sudo usermod -aG gpio $USER, and log in again)");
    CHECK(
        complaint({shut_chip(0, ENOTTY, "")}, by_chip("/dev/gpiochip0", 17)) ==
        "GPIO line 17 of /dev/gpiochip0: /dev/gpiochip0 is not a GPIO chip (tactor devices lists the chips)");
    // An unneeded chip does not matter.
    CHECK(find_line(std::vector{shut_chip(0, EACCES, "gpio"), make_chip(1, "other", {"x"})}, by_name("x"))
              .chip == 1);
}

TEST_CASE("a line without chip, offset and name is bad input, with the place where it was written")
{
    CHECK(complaint(pi, {}, error_kind::bad_input) ==
          "GPIO line: a line needs chip and offset, or a name (line = { chip = \"pinctrl-rp1\", offset = 17 "
          "} or { name = \"GPIO17\" })");
    gpio_line_name half;
    half.chip = "pinctrl-rp1";
    half.where = {"palm.toml", 12, 3};
    CHECK(complaint(pi, half, error_kind::bad_input).starts_with("palm.toml:12:3: GPIO line: a line needs"));
}

TEST_CASE("a long list is cut")
{
    std::vector<std::string> names;
    for (int i = 0; i < 54; ++i)
        names.push_back("PIN" + std::to_string(i));
    const std::string text = complaint({make_chip(0, "c", names)}, by_name("amplifier"));
    CHECK(text.find("PIN11 and 42 more)") != std::string::npos);
}

TEST_CASE("a busy line is named with its holder")
{
    CHECK(refusal(EBUSY, "gpiomon") == "palm.toml:12:1: GPIO line 17 of pinctrl-rp1: busy: \"gpiomon\" holds "
                                       "it (stop that program, or choose another line)");
    CHECK(refusal(EBUSY, "tactor") == "palm.toml:12:1: GPIO line 17 of pinctrl-rp1: busy: another tactor "
                                      "holds it (stop that tactor first)");
    CHECK(refusal(EBUSY, amplifier::nameless_consumer) ==
          "palm.toml:12:1: GPIO line 17 of pinctrl-rp1: busy: a driver or overlay of the kernel holds it "
          "(choose another line)");
    has(refusal(EBUSY, ""), "busy: a driver or overlay of the kernel holds it");
}

TEST_CASE("a missing ability of the chip is reported as such")
{
    has(refusal(ENOTSUP, ""), "the chip cannot do this with the line: ");
    has(refusal(EPERM, ""), "the kernel does not permit this use of the line");
    has(refusal(EIO, ""), "the line cannot be opened: ");
}

TEST_CASE("a listed chip that cannot be opened has a hint")
{
    CHECK(amplifier::advice(shut_chip(0, EACCES, "gpio")) ==
          "no permission to open /dev/gpiochip0 (sudo usermod -aG gpio $USER, then log in again)");
}

TEST_CASE("impossible times are refused before any device is touched")
{
    const gpio_line_name l{.name = "no such line"};
    for (const double s :
         {-0.001, 10.001, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        has(complaint([&] { return open_edges(l, edge_kind::rising, s); }, error_kind::bad_input),
            "a debounce time of");
}

TEST_CASE("chips are listed by number, each once")
{
    const folder f;
    for (const char* name :
         {"gpiochip10", "gpiochip2", "gpiochip0", "gpiochip", "gpiochip1x", "gpiomem", "mygpiochip1"})
        f.write(name);
    fs::create_symlink("gpiochip0", f / "gpiochip4");
    const auto at = [&](const char* name) { return (f / name).string(); };
    CHECK(amplifier::chip_paths(f.path()) == std::vector{at("gpiochip0"), at("gpiochip2"), at("gpiochip10")});
    CHECK(amplifier::chip_paths(f / "nowhere").empty());
}

TEST_CASE("a file's group has a name, a missing file's is the usual one")
{
    CHECK(amplifier::find_group("/dev/null") == "root");
    CHECK(amplifier::find_group("/nowhere") == "gpio");
}

TEST_CASE("a file that is no GPIO chip is not opened")
{
    const folder f;
    f.write("gpiochip0");
    for (const std::string& path :
         {(f / "gpiochip0").string(), std::string("/dev/null"), f.path().string()}) {
        const amplifier::chip c = amplifier::read_chip(path);
        CHECK(c.code != 0);
        CHECK(c.info.path == path);
        CHECK(c.info.lines.empty());
    }
    CHECK(amplifier::read_chip("/nowhere").code == ENOENT);
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
        CHECK(amplifier::find_chip_fault(path) == ENOTTY);
        has(complaint([&] { return find_gpio_line({.chip = path, .offset = 0}); }), "is not a GPIO chip");
    }
    char event[512];
    CHECK(::read(watch, event, sizeof event) == -1);
    CHECK(errno == EAGAIN);
    ::close(watch);
}

TEST_CASE("a path that is no GPIO chip is an error that says so")
{
    const gpio_line_name l{.chip = "/dev/null", .offset = 3};
    const std::string text = complaint([&] { return open_output(l); });
    CHECK(text.starts_with("GPIO line 3 of /dev/null: /dev/null is not a GPIO chip"));
    CHECK(text.ends_with("(tactor devices lists the chips)"));
}

TEST_CASE("an edge passes where no other came before it within the window")
{
    std::mt19937_64 random(20240607);
    for (int round = 0; round < 2000; ++round) {
        const auto window = static_cast<std::int64_t>(random() % 6); // ns, so that some edges end it exactly
        std::vector<std::int64_t> times{0};
        for (int i = 0; i < 50; ++i)
            times.push_back(times.back() + static_cast<std::int64_t>(random() % 9));
        const std::vector<bool> passed = filter(window, times);
        for (std::size_t i = 0; i < times.size(); ++i)
            CHECK(passed[i] == (i == 0 || times[i] - times[i - 1] >= window));
    }
}

} // namespace lines_test
