// SPDX-License-Identifier: MIT
#include "rt/triple_buffer.hpp"

#include <atomic>
#include <cstdint>
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

} // namespace triple_buffer_test
