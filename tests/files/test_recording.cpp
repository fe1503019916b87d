// SPDX-License-Identifier: MIT
// WAV files as waveforms.
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

#include "folder.hpp"
#include "has.hpp"
#include "message_of.hpp"

namespace recording_test {

using namespace tactor;

namespace {

template <class T>
std::string bytes(T v)
{
    std::string s(sizeof v, '\0');
    std::memcpy(s.data(), &v, sizeof v);
    return s;
}

std::string chunk(const std::string& id, const std::string& data)
{
    return id + bytes(static_cast<std::uint32_t>(data.size())) + data + (data.size() % 2 == 1 ? "x" : "");
}

std::string format(std::uint16_t tag, std::uint16_t bits, std::uint16_t channels = 1)
{
    const auto size = static_cast<std::uint16_t>(bits / 8 * channels);
    return bytes(tag) + bytes(channels) + bytes(std::uint32_t{8000}) + bytes(std::uint32_t{8000} * size) +
           bytes(size) + bytes(bits);
}

std::string wav(const std::string& chunks)
{
    return "RIFF" + bytes(static_cast<std::uint32_t>(4 + chunks.size())) + "WAVE" + chunks;
}

template <class T>
std::string samples(std::initializer_list<T> all)
{
    std::string s;
    for (const T v : all)
        s += bytes(v);
    return s;
}

} // namespace

TEST_CASE("a WAV file's samples are read in every format, whatever chunks stand before them")
{
    const folder dir;
    const std::vector<float> expected{0.5F, -0.25F, 0.0F};
    const std::string extensible = format(0xFFFE, 16) + bytes(std::uint16_t{22}) + bytes(std::uint16_t{16}) +
                                   bytes(std::uint32_t{0}) + bytes(std::uint16_t{1}) + std::string(14, '\0');
    const std::vector<std::string> all{
        chunk("fmt ", format(1, 8)) + chunk("data", samples<std::uint8_t>({192, 96, 128})),
        chunk("LIST", "odd") + chunk("fmt ", format(1, 16)) +
            chunk("data", samples<std::int16_t>({16384, -8192, 0})),
        chunk("fmt ", format(1, 24)) + chunk("data", std::string("\0\0\x40\0\0\xE0\0\0\0", 9)),
        chunk("fmt ", format(1, 32)) + chunk("data", samples<std::int32_t>({1 << 30, -(1 << 29), 0})),
        chunk("fmt ", format(3, 32)) + chunk("data", samples<float>({0.5F, -0.25F, 0.0F})),
        chunk("fmt ", format(3, 64)) + chunk("data", samples<double>({0.5, -0.25, 0.0})),
        chunk("fmt ", extensible) + chunk("data", samples<std::int16_t>({16384, -8192, 0})),
    };
    for (const std::string& w : all) {
        const recording r = load_recording(dir.write("a.wav", wav(w)));
        CHECK(r.samples == expected);
        CHECK(r.rate_hz == 8000.0);
    }
}

TEST_CASE("what is no WAV file of one channel is refused by name")
{
    const folder dir;
    const std::string data = chunk("data", samples<std::int16_t>({1000, -1000}));
    const auto refused = [&](const std::string& text, const std::string& part) {
        const std::string said =
            message_of([&] { static_cast<void>(load_recording(dir.write("b.wav", text))); });
        return has(said, part) && has(said, "b.wav");
    };
    CHECK(refused("", "no WAV file"));
    CHECK(refused("RIFF\1\2\3\4WAVE", "no samples"));
    CHECK(refused(wav(data), "before their format"));
    CHECK(refused(wav(chunk("fmt ", "short") + data), "cut off"));
    CHECK(refused(wav(chunk("fmt ", format(1, 12)) + data), "format 1 with 12 bits"));
    CHECK(refused(wav(chunk("fmt ", format(2, 16)) + data), "format 2"));
    CHECK(refused(wav(chunk("fmt ", format(1, 16, 2)) + data), "2 channels"));
    CHECK(refused(wav(chunk("fmt ", format(1, 16)) + chunk("data", "ab")), "1 sample"));
}

TEST_CASE("text that is no file names no file")
{
    const folder dir;
    dir.write("w.wav",
              wav(chunk("fmt ", format(1, 16)) + chunk("data", samples<std::int16_t>({1000, -1000}))));
    const std::string text = "[stroke]\npath = \"M 0 0 L 40 0\"\nwaveform = \"w.wav\"\n";
    const auto all = load_strokes(dir.write("s.toml", text));
    REQUIRE(all.size() == 1);
    REQUIRE(all.front().wave);
    CHECK(all.front().wave->recorded->samples.size() == 2);
    CHECK(has(message_of([&] { static_cast<void>(parse_strokes_toml(text, "text")); }), "text:3"));
    CHECK(has(message_of([&] { static_cast<void>(parse_strokes(text, "text")); }), "text:3"));
}

} // namespace recording_test
