// SPDX-License-Identifier: MIT
#include "sink/wav/wav.hpp"

#include <doctest/doctest.h>

#include <tactor/error.hpp>

namespace header_test {

using namespace tactor;
using wav::container;

namespace {

std::uint64_t number(const std::string& s, std::size_t at, unsigned bytes)
{
    std::uint64_t n = 0;
    for (unsigned i = bytes; i-- > 0;)
        n = n << 8U | static_cast<unsigned char>(s.at(at + i));
    return n;
}

} // namespace

TEST_CASE("integer samples have the plain header of 44 bytes")
{
    const std::string s = wav::header(format_kind::s24_3, container::wave, 9, 44100, 1001);
    REQUIRE(s.size() == 44);
    CHECK(s.substr(0, 4) == "RIFF");
    CHECK(number(s, 4, 4) == 36 + 1001 * 27 + 1); // an odd number of bytes, and one of padding
    CHECK(s.substr(8, 8) == "WAVEfmt ");
    CHECK(number(s, 16, 4) == 16);
    CHECK(number(s, 20, 2) == 1);
    CHECK(number(s, 22, 2) == 9);
    CHECK(number(s, 24, 4) == 44100);
    CHECK(number(s, 28, 4) == 44100 * 27);
    CHECK(number(s, 32, 2) == 27);
    CHECK(number(s, 34, 2) == 24);
    CHECK(s.substr(36, 4) == "data");
    CHECK(number(s, 40, 4) == 1001 * 27);
}

TEST_CASE("formats other than integer PCM have the size of their extension and a fact chunk")
{
    const std::string s = wav::header(format_kind::float32, container::wave, 2, 48000, 500);
    REQUIRE(s.size() == 58);
    CHECK(number(s, 4, 4) == 50 + 4000);
    CHECK(number(s, 16, 4) == 18);
    CHECK(number(s, 20, 2) == 3);
    CHECK(number(s, 36, 2) == 0);
    CHECK(s.substr(38, 4) == "fact");
    CHECK(number(s, 42, 4) == 4);
    CHECK(number(s, 46, 4) == 500);
    CHECK(s.substr(50, 4) == "data");
    CHECK(number(s, 54, 4) == 4000);
}

TEST_CASE("RF64 has its sizes in 64 bits")
{
    const std::uint64_t frames = 10'000'000'000;
    const std::string s = wav::header(format_kind::s16, container::rf64, 3, 48000, frames);
    CHECK(s.substr(0, 4) == "RF64");
    CHECK(number(s, 4, 4) == 0xFFFFFFFF);
    CHECK(s.substr(12, 4) == "ds64");
    CHECK(number(s, 16, 4) == 28);
    CHECK(number(s, 20, 8) == s.size() - 8 + frames * 6);
    CHECK(number(s, 28, 8) == frames * 6);
    CHECK(number(s, 36, 8) == frames);
    CHECK(s.substr(s.size() - 8, 4) == "data");
    CHECK(number(s, s.size() - 4, 4) == 0xFFFFFFFF);
}

TEST_CASE("values that a header cannot hold are bad input")
{
    const auto kind = [](format_kind f, unsigned channels) {
        try {
            wav::header(f, container::wave, channels, 48000, 1);
        } catch (const error& e) {
            return e.kind() == error_kind::bad_input;
        }
        return false;
    };
    CHECK(kind(format_kind::s24_4, 2));
    CHECK_FALSE(kind(format_kind::float32, 1024));
}

} // namespace header_test
