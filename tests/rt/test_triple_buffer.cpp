// SPDX-License-Identifier: MIT
#include "rt/triple_buffer.hpp"

#include <cstdint>
#include <latch>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace triple_buffer_test {

using tactor::rt::triple_buffer;

TEST_CASE("the reader gets the newest value, once as news")
{
    triple_buffer<int> b(7);
    CHECK(b.value() == 7);
    CHECK_FALSE(b.fetch());
    b.draft() = 1;
    CHECK_FALSE(b.has_news());
    b.publish();
    b.draft() = 2;
    b.publish();
    CHECK(b.has_news());
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
    CHECK_FALSE(b.has_news());
    go_on.count_down();
    writer.join();
    CHECK(b.load().b == 3);
}

} // namespace triple_buffer_test
