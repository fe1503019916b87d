// SPDX-License-Identifier: MIT
// WAV files as waveforms.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

#include "core/sha256.hpp"

#include "caught.hpp"
#include "folder.hpp"
#include "has.hpp"

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

std::string long_sizes(const std::string& kind, std::uint64_t data_bytes, const std::string& chunks)
{
    const std::string ds64 = bytes(std::uint64_t{0}) + bytes(data_bytes) + bytes(data_bytes / 2) + bytes(0);
    return kind + bytes(0xFFFFFFFFU) + "WAVE" + chunk("ds64", ds64) + chunks;
}

std::string open_data(std::uint32_t size, const std::string& samples)
{
    return "data" + bytes(size) + samples;
}

std::string in_four_bytes(std::initializer_list<std::int32_t> all, std::int32_t (*as)(std::int32_t))
{
    std::string s;
    for (const std::int32_t v : all)
        s += bytes(as(v));
    const std::string f = bytes(std::uint16_t{1}) + bytes(std::uint16_t{1}) + bytes(std::uint32_t{8000}) +
                          bytes(std::uint32_t{32000}) + bytes(std::uint16_t{4}) + bytes(std::uint16_t{24});
    return wav(chunk("fmt ", f) + chunk("data", s));
}

recording load(const std::string& file)
{
    const folder dir;
    return load_recording(dir.write("a.wav", file));
}

const std::vector<float> expected{0.5F, -0.25F, 0.0F};
const std::string of_16_bits = samples<std::int16_t>({16384, -8192, 0}); ///< these as samples
const std::string head = chunk("fmt ", format(1, 16));
const std::string short_one = wav(head + chunk("data", samples<std::int16_t>({1000, -1000})));

} // namespace

TEST_CASE("a WAV file's samples are read in every format, after any chunks")
{
    const std::string extensible = format(0xFFFE, 16) + bytes(std::uint16_t{22}) + bytes(std::uint16_t{16}) +
                                   bytes(std::uint32_t{0}) + bytes(std::uint16_t{1}) + std::string(14, '\0');
    const std::vector<std::string> all{
        chunk("fmt ", format(1, 8)) + chunk("data", samples<std::uint8_t>({192, 96, 128})),
        chunk("LIST", "odd") + head + chunk("data", of_16_bits),
        chunk("fmt ", format(1, 24)) + chunk("data", std::string("\0\0\x40\0\0\xE0\0\0\0", 9)),
        chunk("fmt ", format(1, 32)) + chunk("data", samples<std::int32_t>({1 << 30, -(1 << 29), 0})),
        chunk("fmt ", format(3, 32)) + chunk("data", samples<float>({0.5F, -0.25F, 0.0F})),
        chunk("fmt ", format(3, 64)) + chunk("data", samples<double>({0.5, -0.25, 0.0})),
        chunk("fmt ", extensible) + chunk("data", of_16_bits),
    };
    for (const std::string& w : all) {
        const recording r = load(wav(w));
        CHECK(r.samples == expected);
        CHECK(r.rate_hz == 8000.0);
    }
}

TEST_CASE("a file that is not a WAV file of one channel is refused by name")
{
    const folder dir;
    const std::string data = chunk("data", samples<std::int16_t>({1000, -1000}));
    const auto refused = [&](const std::string& text, const std::string& part) {
        const std::string said = caught_message([&] { return load_recording(dir.write("b.wav", text)); });
        return has(said, part) && has(said, "b.wav");
    };
    CHECK(refused("", "not a WAV file"));
    CHECK(refused("RIFF\1\2\3\4WAVE", "no samples"));
    CHECK(refused(wav(data), "before their format"));
    CHECK(refused(wav(chunk("fmt ", "short") + data), "incomplete"));
    CHECK(refused(wav(chunk("fmt ", format(1, 40)) + data), "format 1 with 40 bits"));
    CHECK(refused(wav(chunk("fmt ", format(3, 16)) + data), "format 3 with 16 bits"));
    CHECK(refused("RIFF\1\2\3\4AVI LIST", "not a WAV file"));
    CHECK(refused(wav(chunk("fmt ", format(2, 16)) + data), "format 2"));
    CHECK(refused(wav(chunk("fmt ", format(1, 16, 2)) + data), "2 channels"));
    CHECK(refused(wav(head + chunk("data", "ab")), "1 sample"));
}

TEST_CASE("a WAV file of several channels is read without a loss")
{
    const folder dir;
    const auto load = [&](const std::string& text) { return load_samples(dir.write("a.wav", text)); };
    const auto text = [](const own_samples& s) {
        return std::string(reinterpret_cast<const char*>(s.bytes.data()), s.bytes.size());
    };
    const auto check = [&](const std::string& file, format_kind f, const std::string& expected_bytes) {
        const own_samples s = load(file);
        CHECK(s.rate == 8000);
        CHECK(s.channels == 2);
        CHECK(s.format == f);
        CHECK(text(s) == expected_bytes);
        CHECK(has(s.file, "a.wav"));
    };
    const std::string two = samples<std::int16_t>({16384, -8192, 0, 1});
    check(wav(chunk("fmt ", format(1, 16, 2)) + chunk("data", two)), format_kind::s16, two);
    const std::string five = samples<float>({0.1F, -0.25F, 1e-30F, 1.0F});
    check(wav(chunk("fmt ", format(3, 32, 2)) + chunk("LIST", "odd") + chunk("data", five)),
          format_kind::float32, five);
    const std::string whole = samples<std::int32_t>({1, -1, 1 << 30, 3});
    check(wav(chunk("fmt ", format(1, 32, 2)) + chunk("data", whole)), format_kind::s32, whole);
    const std::string three("\1\2\x40\0\3\xE0", 6);
    check(wav(chunk("fmt ", format(1, 24, 2)) + chunk("data", three)), format_kind::s24_3, three);
    check(wav(chunk("fmt ", format(1, 8, 2)) + chunk("data", samples<std::uint8_t>({0, 255, 128, 129}))),
          format_kind::float32, samples<float>({-1.0F, 0.9921875F, 0.0F, 0.0078125F}));
    check(wav(chunk("fmt ", format(3, 64, 2)) + chunk("data", samples<double>({0.1, -0.25}))),
          format_kind::float32, samples<float>({0.1F, -0.25F}));
    check(long_sizes("RF64", 8, chunk("fmt ", format(1, 16, 2)) + "data" + bytes(0xFFFFFFFFU) + two),
          format_kind::s16, two);
    const std::string in_four = bytes(std::uint16_t{1}) + bytes(std::uint16_t{2}) +
                                bytes(std::uint32_t{8000}) + bytes(std::uint32_t{64000}) +
                                bytes(std::uint16_t{8}) + bytes(std::uint16_t{24});
    const std::string lower = samples<std::int32_t>({0x123456, -5});
    check(wav(chunk("fmt ", in_four) + chunk("data", lower)), format_kind::s24_4, lower);
    const std::string upper = samples<std::int32_t>({0x12345600, -5 * 256});
    check(wav(chunk("fmt ", in_four) + chunk("data", upper)), format_kind::s32, upper);
    check(wav(chunk("fmt ", format(1, 16, 2)) + open_data(0xFFFFFFFFU, two + "odd")), format_kind::s16, two);
    CHECK(has(caught_message([&] { load(wav(chunk("fmt ", format(1, 16, 2)) + open_data(80, two))); }),
              "a.wav: it is cut short: 2 of 20 frames are there"));
    CHECK(has(caught_message([&] { load(wav(chunk("fmt ", format(1, 16, 0)) + chunk("data", two))); }),
              "0 channels"));
}

TEST_CASE("24 bits in four bytes are found at either end, however quiet")
{
    const std::initializer_list<std::int32_t> loud{0, 4194304, -2097152, 8388607, -8388608};
    const std::initializer_list<std::int32_t> quiet{0, 40, -20, 80, -81};
    const std::initializer_list<std::int32_t> whole_bytes{0, 16384 * 256, -8192 * 256};
    using four_bytes = std::int32_t (*)(std::int32_t);
    const four_bytes ways[] = {
        [](std::int32_t v) { return v; }, [](std::int32_t v) { return v & 0xFFFFFF; },
        [](std::int32_t v) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(v) << 8U); }};
    for (const auto& all : {loud, quiet, whole_bytes}) {
        // Only the shape is played: the position of quiet samples cannot be known.
        const auto shape = [](std::vector<float> x) {
            float peak = 0.0F;
            for (const float v : x)
                peak = std::max(peak, std::abs(v));
            for (float& v : x)
                v /= peak;
            return x;
        };
        std::vector<float> values;
        for (const std::int32_t v : all)
            values.push_back(static_cast<float>(v) / 8388608.0F);
        for (const four_bytes as : ways)
            CHECK(shape(load(in_four_bytes(all, as)).samples) == shape(values));
    }
}

TEST_CASE("sizes that a recorder left open end with the file")
{
    for (const std::uint32_t size : {0U, 0xFFFFFFFFU, 0x7FFFFFFFU, 0x7FFFF000U, 0x80000000U}) {
        CAPTURE(size);
        const recording r = load(wav(head + open_data(size, of_16_bits)));
        CHECK(r.samples == expected);
        CHECK(r.missing == 0);
    }
    // An empty recording does not count as one of unknown size.
    has(caught_message([] { return load(wav(head + open_data(0, chunk("LIST", "INFO")))); }), "0 samples");
}

TEST_CASE("long files give their size elsewhere, and later chunks are no samples")
{
    const std::string behind = chunk("LIST", "INFOICMT\x04\0\0\0loud");
    const std::string chunks = head + open_data(0xFFFFFFFFU, of_16_bits) + behind;
    for (const char* kind : {"RF64", "BW64"})
        CHECK(load(long_sizes(kind, 6, chunks)).samples == expected);
}

TEST_CASE("chunks of odd size may be anywhere, with or without padding")
{
    const std::string data = chunk("data", of_16_bits);
    const std::string bare = "LIST" + bytes(std::uint32_t{7}) + "INFOodd";
    for (const std::string& list : {chunk("LIST", "INFOodd"), bare})
        for (const std::string& w : {list + head + data, head + list + data, head + data + list})
            CHECK(load(wav(w)).samples == expected);
}

TEST_CASE("a recording that is cut short says how much is missing")
{
    CHECK(load(wav(head + open_data(16, of_16_bits))).missing == 5);
    CHECK(load(wav(head + open_data(6, of_16_bits))).missing == 0);
    CHECK(load(long_sizes("RF64", 20, head + open_data(0xFFFFFFFFU, of_16_bits))).missing == 7);
}

TEST_CASE("a recording knows the hash of its file")
{
    CHECK(load(short_one).sha256 == detail::sha256_text(short_one));
}

TEST_CASE("text that is not a file cannot name a recording")
{
    const folder dir;
    dir.write("w.wav", short_one);
    const std::string text = "[stroke]\npath = \"M 0 0 L 40 0\"\nwaveform = \"w.wav\"\n";
    const auto all = load_strokes(dir.write("s.toml", text));
    REQUIRE(all.size() == 1);
    REQUIRE(all.front().sound.wave);
    CHECK(all.front().sound.wave->recorded->samples.size() == 2);
    has(caught_message([&] { return parse_strokes_toml(text, "text"); }), "text:3");
    has(caught_message([&] { return parse_strokes(text, "text"); }), "text:3");
}

} // namespace recording_test
