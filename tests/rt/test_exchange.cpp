// SPDX-License-Identifier: MIT
// Exchange between threads: the ring, the newest value, and the descriptor that wakes.
#include "rt/spsc_ring.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <latch>
#include <limits>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <poll.h>

#include <doctest/doctest.h>

#include "rt/event_fd.hpp"
#include "rt/triple_buffer.hpp"

namespace exchange_test {

using tactor::rt::spsc_ring;
using tactor::rt::triple_buffer;

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

TEST_CASE("the reader gets the newest value, once as news")
{
    triple_buffer<int> b(7);
    CHECK(b.value() == 7);
    CHECK_FALSE(b.fetch());
    b.draft() = 1;
    CHECK_FALSE(b.has_new_value());
    b.publish();
    b.draft() = 2;
    b.publish();
    CHECK(b.has_new_value());
    CHECK(b.value() == 7);
    CHECK(b.fetch());
    CHECK(b.value() == 2);
    CHECK_FALSE(b.fetch());
    CHECK(b.value() == 2);
    b.draft() = 3;
    b.publish();
    CHECK(b.fetch());
    CHECK(b.value() == 3);
}

TEST_CASE("the reader never gets half a value, never an older one, and at last the last")
{
    constexpr std::uint64_t last = 200'000;
    triple_buffer<std::vector<std::uint64_t>> b(std::vector<std::uint64_t>(16, 0));
    std::thread writer([&] {
        for (std::uint64_t i = 1; i <= last; ++i) {
            for (std::uint64_t& x : b.draft())
                x = i;
            b.publish();
        }
    });
    std::uint64_t before = 0;
    std::uint64_t wrong = 0;
    while (before < last) {
        if (!b.fetch())
            continue;
        const std::vector<std::uint64_t>& v = b.value();
        for (const std::uint64_t x : v)
            wrong += static_cast<std::uint64_t>(x != v[0]);
        wrong += static_cast<std::uint64_t>(v[0] <= before);
        before = v[0];
    }
    writer.join();
    CHECK(wrong == 0);
}

namespace {

/// A value whose writer is stopped half-way through a copy, like one that loses its processor there.
struct slow_value {
    slow_value() = default;
    explicit slow_value(int n) : a(n), b(n) {}
    slow_value(const slow_value&) = default;
    slow_value& operator=(const slow_value& v)
    {
        a = v.a;
        if (stopped != nullptr) {
            stopped->count_down();
            go_on->wait();
        }
        b = v.b;
        return *this;
    }
    ~slow_value() = default;

    int a = 0;
    int b = 0;
    static inline thread_local std::latch* stopped = nullptr;
    static inline std::latch* go_on = nullptr;
};

} // namespace

TEST_CASE("a writer stopped in the middle delays no reader: it gets the value before, whole")
{
    triple_buffer<slow_value> b;
    std::latch stopped(1);
    std::latch go_on(1);
    slow_value::go_on = &go_on;
    b.store(slow_value(1));
    std::thread writer([&] {
        b.store(slow_value(2));
        slow_value::stopped = &stopped;
        b.store(slow_value(3));
    });
    stopped.wait();
    for (int i = 0; i < 3; ++i) {
        const slow_value& v = b.load();
        CHECK(v.a == 2);
        CHECK(v.b == 2);
    }
    CHECK_FALSE(b.has_new_value());
    go_on.count_down();
    writer.join();
    CHECK(b.load().b == 3);
}

TEST_CASE("an eventfd is readable after a signal and not after it was consumed")
{
    tactor::rt::event_fd e;
    pollfd p{.fd = e.fd(), .events = POLLIN, .revents = 0};
    CHECK(::poll(&p, 1, 0) == 0);
    CHECK(e.consume() == 0);
    e.signal();
    e.signal();
    CHECK(::poll(&p, 1, 0) == 1);
    CHECK(e.consume() == 2);
    CHECK(::poll(&p, 1, 0) == 0);
}

TEST_CASE("an eventfd does not block and is not inherited by programs")
{
    tactor::rt::event_fd e;
    CHECK((::fcntl(e.fd(), F_GETFL) & O_NONBLOCK) != 0);
    CHECK((::fcntl(e.fd(), F_GETFD) & FD_CLOEXEC) != 0);
}

} // namespace exchange_test
