// SPDX-License-Identifier: MIT
// `tactor play` with an amplifier, killed at its system calls, one after the other, from the one at which it
// has a holder on: in any thread, the line ends off. TACTOR_SOAK=whole: at every one.
//   TACTOR_TOOL: the tool; TACTOR_ARRAY: a file of an array with the amplifier's line; TACTOR_LINE: a file
//   that says '0' or '1'. With TACTOR_FAKE_GPIOD (fake_gpiod.cpp) both are made here.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include "folder.hpp"
#include "rounds.hpp"
#include "traced.hpp"

namespace killed_test {

using namespace tactor::test;

namespace {

std::string variable(const char* name)
{
    const char* v = std::getenv(name);
    return v == nullptr ? "" : v;
}

/// The amplifier's line, and an array file with it.
struct bench {
    std::string array = variable("TACTOR_ARRAY");
    std::string line = variable("TACTOR_LINE");

    explicit bench(const std::string& folder)
    {
        ::setenv("TACTOR_CONFIG", "/dev/null", 1);
        ::setenv("XDG_RUNTIME_DIR", "", 1);
        ::setenv("RUNTIME_DIRECTORY", "", 1);
        if (variable("TACTOR_FAKE_GPIOD").empty())
            return;
        line = folder + "/line";
        array = folder + "/array.toml";
        std::ofstream(line) << '0';
        std::ofstream(array) << "[array]\nname = \"one\"\n[[tactor]]\nx_mm = 0.0\ny_mm = 0.0\nchannel = 0\n"
                                "[amplifier]\nsettle_ms = 0.0\nline = { chip = \"/dev/null\", offset = 0 }\n";
        ::setenv("TACTOR_LINE", line.c_str(), 1);
    }
    bool is_on() const
    {
        char c = 0;
        std::ifstream(line).get(c);
        if (c != '0' && c != '1')
            throw std::runtime_error(line + " says neither 0 nor 1");
        return c == '1';
    }
};

void silence()
{
    const int null = ::open("/dev/null", O_RDWR);
    for (const int fd : {0, 1, 2})
        ::dup2(null, fd);
}

void play(const bench& on)
{
    silence();
    const std::string tool = variable("TACTOR_TOOL");
    if (const std::string fake = variable("TACTOR_FAKE_GPIOD"); !fake.empty())
        ::setenv("LD_PRELOAD", fake.c_str(), 1);
    std::array<const char*, 20> words{tool.c_str(),  "play",       "--path",          "M 0 0 L 0.001 0",
                                      "--algorithm", "continuous", "--duration",      "0.05",
                                      "--outside",   "clamp",      "--array",         on.array.c_str(),
                                      "-D",          "null",       "--period-frames", "960",
                                      nullptr};
    ::execv(tool.c_str(), const_cast<char**>(words.data()));
    ::_exit(127);
}

} // namespace

TEST_CASE("play that is killed at any system call leaves the amplifier off")
{
    if (!can_trace()) {
        std::printf("SKIPPED: play killed at its system calls: processes cannot be traced here\n");
        return;
    }
    const folder own;
    const bench on(own.path().string());
    unsigned kills = 0;
    unsigned while_on = 0;
    const unsigned step = rounds(1, 2) == 2 ? 1 : 5;
    for (unsigned nth = 0;; nth += step) {
        REQUIRE(nth < 20000);
        traced_session s([&on] { play(on); }, traced_session::counts::with_holder);
        const killed k =
            s.kill_at(party::player, nth, party::player, [&] { while_on += on.is_on() ? 1 : 0; });
        CAPTURE(nth);
        CHECK_FALSE(on.is_on());
        if (!k.reached)
            break;
        ++kills;
    }
    std::printf("play killed at %u system calls, at %u of which the amplifier was on\n", kills, while_on);
    CHECK(kills > 10);
    CHECK(while_on > 3);
    CHECK(while_on < kills);
}

} // namespace killed_test
