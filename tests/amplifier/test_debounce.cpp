// SPDX-License-Identifier: MIT
#include "amplifier/line.hpp"

#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace debounce_test {

using tactor::amplifier::debounce;

namespace {

std::vector<bool> filter(std::int64_t window, const std::vector<std::int64_t>& times)
{
    debounce d(window);
    std::vector<bool> out;
    for (const std::int64_t t : times)
        out.push_back(d.accepts(t));
    return out;
}

} // namespace

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

} // namespace debounce_test
