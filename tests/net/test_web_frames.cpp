// SPDX-License-Identifier: MIT
// Ends of messages in the bytes of a WebSocket.
#include "net/web_frames.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace web_frames_test {

using tactor::net::web_frames;

namespace {

using bytes = std::vector<std::byte>;

constexpr unsigned text = 1;
constexpr unsigned continuation = 0;
constexpr unsigned ping = 9;

bytes framed(unsigned kind, std::size_t size, bool last = true, bool masked = true)
{
    bytes b{std::byte(kind | (last ? 0x80U : 0U))};
    const unsigned mask = masked ? 0x80U : 0U;
    const auto add_length = [&](unsigned said, int length_bytes) {
        b.push_back(std::byte(mask | said));
        for (int i = length_bytes - 1; i >= 0; --i)
            b.push_back(std::byte(size >> (8 * i) & 0xff));
    };
    if (size < 126)
        add_length(static_cast<unsigned>(size), 0);
    else if (size < 65536)
        add_length(126, 2);
    else
        add_length(127, 8);
    // Its content looks like any frame.
    b.resize(b.size() + (masked ? 4 : 0) + size, std::byte{0x81});
    return b;
}

} // namespace

TEST_CASE("messages of any size, in any pieces, are open from their first byte to their last")
{
    std::mt19937 random(3);
    for (const std::size_t size : {0U, 1U, 125U, 126U, 65535U, 65536U, 70000U})
        for (const bool masked : {true, false}) {
            CAPTURE(size);
            CAPTURE(masked);
            web_frames f;
            const bytes all = framed(text, size, true, masked);
            for (std::size_t at = 0; at < all.size();) {
                const std::size_t n = std::min<std::size_t>(all.size() - at, 1 + random() % 5000);
                f.take({&all[at], n});
                at += n;
                CHECK(f.open() == (at < all.size()));
            }
            CHECK(f.whole() == 1);
        }
}

TEST_CASE("a message in fragments is open between them, with any control frames")
{
    web_frames f;
    const auto take = [&f](const bytes& b) { f.take(b); };
    CHECK_FALSE(f.open());
    take(framed(ping, 3));
    CHECK_FALSE(f.open());
    CHECK(f.whole() == 0);
    take(framed(text, 0, false));
    CHECK(f.open());
    take(framed(ping, 0));
    CHECK(f.open());
    take(framed(continuation, 5, false));
    CHECK(f.open());
    take(framed(continuation, 0));
    CHECK_FALSE(f.open());
    CHECK(f.whole() == 1);
    bytes two = framed(text, 7);
    const bytes next = framed(text, 300, false);
    two.insert(two.end(), next.begin(), next.begin() + 2);
    take(two);
    CHECK(f.open());
    CHECK(f.whole() == 2);
}

TEST_CASE("a close frame's reason is UTF-8 or not, in any pieces, masked or not")
{
    const auto closing = [](std::string reason, bool masked) {
        bytes b{std::byte{0x88}, std::byte((masked ? 0x80U : 0U) | (2 + reason.size()))};
        const std::string mask = masked ? "abcd" : std::string(4, '\0');
        for (std::size_t i = 0; masked && i < 4; ++i)
            b.push_back(std::byte(mask[i]));
        reason.insert(0, "\x03\xe8");
        for (std::size_t i = 0; i < reason.size(); ++i)
            b.push_back(std::byte(reason[i]) ^ std::byte(mask[i % 4]));
        return b;
    };
    const std::vector<std::pair<const char*, bool>> reasons{
        {"", false},    {"bye", false},     {"sp\xc3\xa4ter", false},
        {"\xff", true}, {"cut \xc3", true}, {"\xed\xa0\x80", true}};
    for (const auto& [reason, bad] : reasons)
        for (const bool masked : {true, false})
            for (const std::size_t step : {1U, 3U, 200U}) {
                CAPTURE(reason);
                web_frames f;
                f.take(framed(text, 5));
                const bytes all = closing(reason, masked);
                for (std::size_t i = 0; i < all.size(); i += step)
                    f.take({&all[i], std::min(step, all.size() - i)});
                CHECK(f.has_bad_reason() == bad);
            }
}

} // namespace web_frames_test
