// SPDX-License-Identifier: MIT
#include "rt/seqlock.hpp"

#include <atomic>
#include <thread>

#include <doctest/doctest.h>

namespace seqlock_test {

namespace {

struct value {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::uint32_t c = 0;
};

} // namespace

TEST_CASE("a reader gets what was stored")
{
    tactor::rt::seqlock<value> lock;
    CHECK(lock.load().a == 0);
    lock.store({1, 2, 3});
    CHECK(lock.load().a == 1);
    CHECK(lock.load().b == 2);
    CHECK(lock.load().c == 3);
}

TEST_CASE("a reader never gets half of a value, and never an older one than before")
{
    tactor::rt::seqlock<value> lock;
    std::atomic<bool> reading{false};
    constexpr std::uint64_t last = 200'000;
    std::thread writer([&] {
        reading.wait(false);
        for (std::uint64_t i = 1; i <= last; ++i)
            lock.store({i, ~i, static_cast<std::uint32_t>(i)});
    });
    reading = true;
    reading.notify_one();
    std::uint64_t before = 0;
    std::uint64_t wrong = 0;
    while (before < last) {
        const value v = lock.load();
        if (v.a == 0)
            continue;
        wrong += static_cast<std::uint64_t>(v.b != ~v.a || v.c != static_cast<std::uint32_t>(v.a));
        wrong += static_cast<std::uint64_t>(v.a < before);
        before = v.a;
    }
    writer.join();
    CHECK(wrong == 0);
}

} // namespace seqlock_test
