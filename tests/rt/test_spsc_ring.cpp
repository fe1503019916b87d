// SPDX-License-Identifier: MIT
#include "rt/spsc_ring.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace spsc_ring_test {

using tactor::rt::spsc_ring;

TEST_CASE("capacity is the next power of two")
{
    CHECK(spsc_ring<int>(0).capacity() == 1);
    CHECK(spsc_ring<int>(1).capacity() == 1);
    CHECK(spsc_ring<int>(3).capacity() == 4);
    CHECK(spsc_ring<int>(64).capacity() == 64);
    CHECK(spsc_ring<int>(65).capacity() == 128);
}

TEST_CASE("the ring behaves like a deque of bounded length")
{
    std::mt19937_64 random(1);
    for (int round = 0; round < 2000; ++round) {
        // The indices wrap on the way.
        spsc_ring<std::uint32_t> ring(1 + random() % 40,
                                      std::numeric_limits<std::size_t>::max() - random() % 500);
        std::deque<std::uint32_t> model;
        std::vector<std::uint32_t> some;
        for (int step = 0; step < 200; ++step) {
            switch (random() % 4) {
            case 0: {
                const auto v = static_cast<std::uint32_t>(random());
                const bool fits = model.size() < ring.capacity();
                REQUIRE(ring.push(v) == fits);
                if (fits)
                    model.push_back(v);
                break;
            }
            case 1: {
                some.resize(random() % 50);
                for (auto& v : some)
                    v = static_cast<std::uint32_t>(random());
                const std::size_t n = ring.push(std::span<const std::uint32_t>(some));
                REQUIRE(n == std::min(some.size(), ring.capacity() - model.size()));
                model.insert(model.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n));
                break;
            }
            default: {
                std::uint32_t v = 0;
                REQUIRE(ring.pop(v) == !model.empty());
                if (!model.empty()) {
                    REQUIRE(v == model.front());
                    model.pop_front();
                }
            }
            }
            REQUIRE(ring.size() == model.size());
            REQUIRE(ring.available() == ring.capacity() - model.size());
            REQUIRE((ring.front() != nullptr) == !model.empty());
        }
    }
}

namespace {

// Wider than any atomic, so that a torn element would show.
struct wide {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::uint64_t c = 0;
};

void stress(std::size_t size, std::uint64_t count)
{
    spsc_ring<wide> ring(size, std::numeric_limits<std::size_t>::max() - 1000);
    std::thread producer([&] {
        for (std::uint64_t i = 0; i < count;)
            if (ring.push(wide{i, ~i, i * 3}))
                ++i;
            else
                std::this_thread::yield();
    });
    std::uint64_t wrong = 0;
    for (std::uint64_t i = 0; i < count;) {
        wide w;
        if (!ring.pop(w)) {
            std::this_thread::yield();
            continue;
        }
        wrong += static_cast<std::uint64_t>(w.a != i || w.b != ~i || w.c != i * 3);
        ++i;
    }
    producer.join();
    CHECK(wrong == 0);
    CHECK(ring.size() == 0);
}

} // namespace

TEST_CASE("two threads lose, double and tear nothing")
{
    // Beside busy loops each change of sides may take a slice of the processor, 4 ms.
    stress(1, 1'000);
    stress(2, 4'000);
    stress(64, 200'000);
    stress(1024, 1'000'000);
}

} // namespace spsc_ring_test
