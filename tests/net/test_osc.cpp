// SPDX-License-Identifier: MIT
// Packets of OSC: their values, and their faults.
#include "net/osc.hpp"

#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "caught.hpp"
#include "has.hpp"

namespace osc_test {

using namespace tactor;
using namespace tactor::net;
using namespace std::string_literals;

namespace {

std::string big_endian(std::uint64_t n, int bytes)
{
    std::string s;
    for (int i = bytes - 1; i >= 0; --i)
        s += static_cast<char>(n >> (8 * i) & 0xffU);
    return s;
}

std::string padded(std::string s)
{
    s += std::string(4 - s.size() % 4, '\0');
    return s;
}

std::string bundle(std::uint64_t tag, const std::vector<std::string>& elements)
{
    std::string b = "#bundle\0"s + big_endian(tag, 8);
    for (const std::string& e : elements)
        b += big_endian(e.size(), 4) + e;
    return b;
}

const std::string stop = padded("/tactor/stop") + padded(",");

// Returns why a packet, or the values of a message in it, cannot be read.
std::string refusal(const std::string& packet)
{
    std::string fault;
    const std::string refused = caught_message([&] {
        for (const osc_message& m : parse_osc(packet))
            fault += m.fault;
    });
    return refused + fault;
}

} // namespace

TEST_CASE("a message matches the standard's example, byte by byte")
{
    // OSC 1.0's second example: /foo with two integers, a text and two floats.
    const std::string packet = "/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0"
                               "\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d"s;
    const auto all = parse_osc(packet);
    REQUIRE(all.size() == 1);
    CHECK(all[0].address == "/foo");
    REQUIRE(all[0].values.size() == 5);
    CHECK(std::get<std::int64_t>(all[0].values[0]) == 1000);
    CHECK(std::get<std::int64_t>(all[0].values[1]) == -1);
    CHECK(std::get<std::string>(all[0].values[2]) == "hello");
    CHECK(std::get<double>(all[0].values[3]) == double{1.234F});
    CHECK(std::get<double>(all[0].values[4]) == double{5.678F});
    CHECK_FALSE(all[0].unix_ns);
    CHECK(osc_packet("/foo", all[0].values) == packet);
}

TEST_CASE("numbers of 8 bytes are read at any place, and unused types are skipped")
{
    const std::string values = big_endian(1, 4) + big_endian(0xfffffffffffffffeU, 8) +
                               big_endian(0x3ff8000000000000U, 8) + big_endian(3, 4) + padded("abc") +
                               padded("sym");
    const auto m = parse_osc(padded("/x") + padded(",ihdbSTFNI") + values).front();
    REQUIRE(m.values.size() == 9);
    CHECK(std::get<std::int64_t>(m.values[1]) == -2);
    CHECK(std::get<double>(m.values[2]) == 1.5);
    CHECK(std::get<osc_other>(m.values[3]).tag == 'b');
    CHECK(std::get<std::string>(m.values[4]) == "sym");
    for (std::size_t i = 5; i < 9; ++i)
        CHECK(std::get<osc_other>(m.values[i]).tag == "TFNI"[i - 5]);
}

TEST_CASE("a message may have no values, with types and without")
{
    for (const std::string& packet : {stop, padded("/tactor/stop")}) {
        const auto all = parse_osc(packet);
        REQUIRE(all.size() == 1);
        CHECK(all[0].address == "/tactor/stop");
        CHECK(all[0].values.empty());
    }
}

TEST_CASE("bundles give each message the time of the innermost")
{
    // 2 s after 1970, and a quarter; then a time after 2036, whose seconds begin anew.
    const std::uint64_t early = (std::uint64_t{2'208'988'802U} << 32U) | 0x40000000U;
    const std::uint64_t late = std::uint64_t{16} << 32U;
    const auto all = parse_osc(bundle(early, {stop, bundle(1, {stop}), bundle(late, {stop}), bundle(0, {})}));
    REQUIRE(all.size() == 3);
    CHECK(all[0].unix_ns == 2'250'000'000);
    CHECK_FALSE(all[1].unix_ns);
    CHECK(all[2].unix_ns == (std::int64_t{4'294'967'296} + 16 - 2'208'988'800) * 1'000'000'000);
    CHECK(parse_osc(bundle(1, {})).empty());
}

TEST_CASE("a broken packet gives the reason, and so do values that cannot be read")
{
    struct broken {
        std::string packet;
        const char* says;
    };
    const std::string whole = padded("/a") + padded(",i") + big_endian(7, 4);
    for (const auto& [packet, says] : std::initializer_list<broken>{
             {"", "it is empty"},
             {"/a\0"s, "3 bytes"},
             {"abcd", "does not begin with /"},
             {"\0\0\0\0"s, "does not begin with /"},
             {"/abc", "address"},
             {"/a\0x"s, "address"},
             {padded("/a") + ",i\0x"s, "types"},
             {padded("/a") + "i\0\0\0"s, "types"},
             {padded("/a") + ",iii", "types"},
             {whole + "\0\0\0\0"s, "do not match"},
             {whole.substr(0, 8), "value"},
             {padded("/a") + padded(",s") + "abcd", "value"},
             {padded("/a") + padded(",b") + big_endian(5, 4) + "abcd", "value"},
             {padded("/a") + padded(",b") + big_endian(0x7fffffff, 4) + "abcd", "value"},
             {padded("/a") + padded(",b") + big_endian(0xffffffff, 4) + "abcd", "value"},
             {padded("/a") + padded(",?") + "abcd", "value"},
             {"#bundle\0"s, "has no time"},
             {"#bundle\0"s + big_endian(1, 4), "has no time"},
             {bundle(1, {stop}) + "\0\0\0\4"s, "an element has 4 bytes, but 0 are left"},
             {bundle(1, {}) + big_endian(0, 4), "0 bytes"},
             {bundle(1, {}) + big_endian(0xfffffffc, 4) + stop, "4294967292 bytes"},
             {bundle(1, {}) + big_endian(6, 4) + "/a\0\0\0\0\0\0"s, "6 bytes"},
             {bundle(1, {stop, "abcd"}), "does not begin with /"},
         }) {
        CAPTURE(packet);
        const std::string said = refusal(packet);
        CHECK_MESSAGE(has(said, says), said);
    }
    const auto all = parse_osc(bundle(1, {padded("/a") + padded(",?") + "abcd", stop}));
    REQUIRE(all.size() == 2);
    CHECK(all[0].address == "/a");
    CHECK_FALSE(all[0].fault.empty());
    CHECK(all[1].fault.empty());
}

TEST_CASE("bundles in bundles and messages have a limit")
{
    std::string deep = stop;
    for (int i = 0; i < 8; ++i)
        deep = bundle(1, {deep});
    CHECK(parse_osc(deep).size() == 1);
    has(refusal(bundle(1, {deep})), "nest deeper than 8");
    for (int i = 0; i < 2000; ++i)
        deep = bundle(1, {deep});
    has(refusal(deep), "nest deeper than 8");
    const std::vector<std::string> many(257, stop);
    has(refusal(bundle(1, many)), "more than 256");
    CHECK(parse_osc(bundle(1, {many.begin(), many.end() - 1})).size() == 256);
}

TEST_CASE("written packets are read back, for any numbers")
{
    const auto m =
        parse_osc(osc_packet("/tactor/stroke", {std::int64_t{1} << 40, -1e300, ""s, "abc"s, "abcd"s}))
            .front();
    CHECK(m.address == "/tactor/stroke");
    REQUIRE(m.values.size() == 5);
    CHECK(std::get<std::int64_t>(m.values[0]) == std::numeric_limits<std::int32_t>::max());
    CHECK(std::isinf(std::get<double>(m.values[1])));
    CHECK(std::get<std::string>(m.values[2]).empty());
    CHECK(std::get<std::string>(m.values[4]) == "abcd");
}

} // namespace osc_test
