// SPDX-License-Identifier: MIT
// Tests against a real kernel: hw FOLDER [doctest options], where FOLDER is that of a gpio-sim chip with at
// least 6 lines, not used before, of which line 2 has a name. Needs root.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <sched.h>

#include "../fake_line.hpp"
#include "sim.hpp"

namespace tactor::test {
namespace {

std::unique_ptr<sim_chip> the_chip;

} // namespace

sim_chip::sim_chip(const std::string& folder) : folder_(folder)
{
    while (folder_.ends_with('/'))
        folder_.pop_back();
}

std::string sim_chip::path() const
{
    return "/dev/" + folder_.substr(folder_.rfind('/') + 1);
}

int sim_chip::value(unsigned line) const
{
    std::ifstream in(folder_ + "/sim_gpio" + std::to_string(line) + "/value");
    int v = -1;
    in >> v;
    return v;
}

void sim_chip::pull(unsigned line, bool up) const
{
    std::ofstream out(folder_ + "/sim_gpio" + std::to_string(line) + "/pull");
    out << (up ? "pull-up" : "pull-down") << std::flush;
    if (!out)
        throw std::runtime_error("cannot pull line " + std::to_string(line));
}

std::optional<std::int64_t> sim_chip::low_at(unsigned line, std::int64_t within_ms) const
{
    const std::int64_t until = now_ns() + within_ms * 1'000'000;
    while (now_ns() < until) {
        if (value(line) == 0)
            return now_ns();
        ::sched_yield();
    }
    return std::nullopt;
}

const sim_chip& chip()
{
    return *the_chip;
}

} // namespace tactor::test

int main(int argc, char** argv)
{
    if (argc < 2 || argv[1][0] == '-') {
        std::fputs("usage: hw /sys/devices/platform/gpio-sim.N/gpiochipM [doctest options]\n", stderr);
        return 2;
    }
    tactor::test::the_chip = std::make_unique<tactor::test::sim_chip>(argv[1]);
    if (tactor::test::chip().value(0) < 0) {
        std::fprintf(stderr, "hw: %s is not the folder of a gpio-sim chip\n", argv[1]);
        return 2;
    }
    doctest::Context context(argc - 1, argv + 1);
    return context.run();
}
