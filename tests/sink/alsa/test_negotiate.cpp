// SPDX-License-Identifier: MIT
// Negotiation with a PCM: the request, the result, and the message when it fails.
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "fake_dac.hpp"
#include "sink/alsa/adopt.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/negotiate.hpp"

namespace negotiate_test {

using namespace tactor;

namespace {

// Two devices of four channels joined to exactly eight.
std::string eight_channels()
{
    std::string s = "pcm.n { type null }\n"
                    "pcm.t { type multi slaves.a { pcm n channels 4 } slaves.b { pcm n channels 4 }\n";
    for (int i = 0; i < 8; ++i)
        s += fmt::format("bindings.{} {{ slave {} channel {} }}\n", i, i < 4 ? 'a' : 'b', i % 4);
    return s + "}\n";
}

const std::string only_s16 = "pcm.n { type null } pcm.t { type linear slave { pcm n format S16_LE } }";
const std::string stereo_44100 =
    "pcm.n { type null } pcm.t { type plug slave { pcm n rate 44100 channels 2 } }";

alsa_options configured(const std::string& text, unsigned channels = 9)
{
    alsa_options o;
    o.pcm = "t";
    o.channels = channels;
    o.config_text = text;
    return o;
}

struct failure {
    error_kind kind = error_kind::runtime;
    std::string text;
    int os_code = 0;

    bool says(const std::string& part) const { return text.find(part) != std::string::npos; }
};

template <typename F>
failure catch_failure(F f)
{
    try {
        f();
    } catch (const error& e) {
        return {e.kind(), e.what(), e.os_code()};
    }
    FAIL("no error");
    return {};
}

failure failure_of_open(const alsa_options& o)
{
    return catch_failure([&] { static_cast<void>(open_alsa(o)); });
}

} // namespace

TEST_CASE("null takes the request, in the first format of the preference")
{
    alsa_options o;
    o.channels = 9;
    const auto s = open_alsa(o);
    CHECK(s->setup().name == "null");
    CHECK(s->setup().channels == 9);
    CHECK(s->setup().rate == 48000);
    CHECK(s->setup().format == format_kind::s32);
    CHECK(s->setup().period_frames == 96);
    CHECK(s->setup().buffer_frames == 288);
}

TEST_CASE("a requested format is used")
{
    for (const format_kind f :
         {format_kind::float32, format_kind::s16, format_kind::s24_3, format_kind::s24_4, format_kind::s32}) {
        alsa_options o;
        o.channels = 1;
        o.format = f;
        CHECK(open_alsa(o)->setup().format == f);
    }
}

TEST_CASE("a device of exactly eight channels takes eight, and says so when asked for nine")
{
    CHECK(open_alsa(configured(eight_channels(), 8))->setup().channels == 8);
    const failure e = failure_of_open(configured(eight_channels(), 9));
    CHECK(e.kind == error_kind::not_available);
    CHECK(e.says("PCM \"t\": cannot play 9 channels at 48000 Hz in s32 or float"));
    CHECK(e.says("refused: channels"));
    CHECK(e.says("channels 8, rates any Hz, formats s32 float"));
}

TEST_CASE("the fewest channels that hold the stream are taken")
{
    alsa_options o = configured(eight_channels(), 5);
    CHECK(failure_of_open(o).says("refused: channels"));
    o.wider = true;
    const auto s = open_alsa(o);
    CHECK(s->setup().channels == 5);
    CHECK(s->setup().device_channels == 8);
    CHECK(s->setup().frame_bytes() == 20);
    o.channels = 9;
    CHECK(failure_of_open(o).says("refused: channels"));
    o = {};
    o.channels = 9;
    o.wider = true;
    CHECK(open_alsa(o)->setup().device_channels == 9);
}

TEST_CASE("a card of 2, 8 or 16 channels and no other takes 16 for nine")
{
    test::fake_dac dac({.channel_counts = {2, 8, 16}});
    alsa_options o;
    o.channels = 9;
    o.wider = true;
    CHECK(alsa::adopt(dac.pcm(), o)->setup().device_channels == 16);
}

TEST_CASE("channels beyond the stream's are silent, whatever was in their memory")
{
    test::fake_dac dac({.least_channels = 16, .most_channels = 16});
    alsa_options o;
    o.channels = 3;
    o.format = format_kind::s16;
    o.wider = true;
    const auto s = alsa::adopt(dac.pcm(), o);
    REQUIRE(s->prepare() == io_kind::ok);
    std::vector<std::int16_t> frames;
    for (std::int16_t v = 1; v <= 3 * 288; ++v)
        frames.push_back(v);
    const std::span<const std::byte> bytes = std::as_bytes(std::span(frames));
    // In two parts, of which the second begins in mid-stream.
    REQUIRE(s->write(bytes.first(100 * 6)).frames == 100);
    REQUIRE(s->write(bytes.subspan(100 * 6)).frames == 188);
    const std::vector<std::byte> got = dac.captured();
    REQUIRE(got.size() == 288 * 32);
    for (std::size_t f = 0; f < 288; ++f) {
        std::int16_t sample[16];
        std::memcpy(sample, &got[f * 32], 32);
        for (std::size_t c = 0; c < 16; ++c)
            REQUIRE(sample[c] == (c < 3 ? static_cast<int>(3 * f + c + 1) : 0));
    }
}

TEST_CASE("a missing format is refused by name")
{
    alsa_options o = configured(only_s16);
    // A linear plugin converts among integers, which NO_AUTO_FORMAT does not stop: its owner asked for it.
    CHECK(open_alsa(o)->setup().format == format_kind::s32);
    o.format = format_kind::float32;
    const failure e = failure_of_open(o);
    CHECK(e.kind == error_kind::not_available);
    CHECK(e.says("9 channels at 48000 Hz in float"));
    CHECK(e.says("refused: format"));
    CHECK(e.says("it can do channels any, rates any Hz, formats s32"));
}

TEST_CASE("plug neither resamples nor mixes channels behind the user's back")
{
    const failure e = failure_of_open(configured(stereo_44100));
    CHECK(e.kind == error_kind::not_available);
    CHECK(e.says("refused: channels, rate"));
    CHECK(e.says("channels 2, rates 44100 Hz"));
    alsa_options o = configured(stereo_44100, 2);
    o.rate = 44100;
    CHECK(open_alsa(o)->setup().rate == 44100);
}

TEST_CASE("an unknown PCM is reported as unknown")
{
    for (const char* name : {"no-such-pcm", "hw:CARD=NoSuchCard", "hw:31", "", "null:1,2,3,4"}) {
        CAPTURE(name);
        alsa_options o;
        o.pcm = name;
        o.channels = 9;
        const failure e = failure_of_open(o);
        CHECK(e.kind == error_kind::not_available);
        CHECK(e.says("PCM \"" + std::string(name) + "\": "));
        CHECK(e.says("tactor devices"));
    }
    alsa_options o;
    o.pcm = "no-such-pcm";
    o.channels = 9;
    CHECK(failure_of_open(o).says("no such PCM"));
}

TEST_CASE("opening prints nothing")
{
    std::FILE* catcher = std::tmpfile();
    REQUIRE(catcher != nullptr);
    const int before = ::dup(STDERR_FILENO);
    ::dup2(::fileno(catcher), STDERR_FILENO);
    alsa_options o;
    o.pcm = "hw:CARD=NoSuchCard";
    o.channels = 1;
    const failure e = failure_of_open(o);
    ::dup2(before, STDERR_FILENO);
    ::close(before);
    CHECK(std::ftell(catcher) == 0);
    CHECK(::lseek(::fileno(catcher), 0, SEEK_END) == 0);
    std::fclose(catcher);
    CHECK(e.says("NoSuchCard"));
}

TEST_CASE("configuration text that ALSA cannot read is bad input")
{
    const failure e = failure_of_open(configured("pcm.t { type "));
    CHECK(e.kind == error_kind::bad_input);
    CHECK(e.says("ALSA configuration text"));
    CHECK(e.os_code == EINVAL);
    CHECK(failure_of_open(configured("pcm.other { type null }")).kind == error_kind::not_available);
    CHECK(failure_of_open(configured("pcm.t { type no_such_type }")).kind == error_kind::not_available);
}

TEST_CASE("impossible numbers of a PCM are bad input")
{
    const auto with = [](auto change) {
        alsa_options o;
        o.channels = 9;
        change(o);
        return failure_of_open(o).kind;
    };
    CHECK(with([](alsa_options& o) { o.channels = 0; }) == error_kind::bad_input);
    CHECK(with([](alsa_options& o) { o.channels = 1025; }) == error_kind::bad_input);
    CHECK(with([](alsa_options& o) { o.rate = 0; }) == error_kind::bad_input);
    CHECK(with([](alsa_options& o) { o.rate = 4'000'000'000; }) == error_kind::bad_input);
    CHECK(with([](alsa_options& o) { o.period_frames = 0; }) == error_kind::bad_input);
    for (const auto& [rate, least] : {std::pair(8000U, 1U), std::pair(48'000U, 3U), std::pair(60'000U, 3U),
                                      std::pair(60'001U, 4U), std::pair(768'000U, 39U)}) {
        alsa_options o = {.pcm = "null", .channels = 9, .rate = rate, .period_frames = least};
        CHECK_NOTHROW(alsa::check(o));
        --o.period_frames;
        const failure e = catch_failure([&] { alsa::check(o); });
        CHECK(e.kind == error_kind::bad_input);
        CHECK(e.says(fmt::format("{} frames a period out of range (give {} to 1048576)", least - 1, least)));
    }
    CHECK(with([](alsa_options& o) { o.period_frames = 4'000'000'000; }) == error_kind::bad_input);
    CHECK(with([](alsa_options& o) { o.periods = 1; }) == error_kind::bad_input);
    CHECK(with([](alsa_options& o) { o.periods = 4'000'000'000; }) == error_kind::bad_input);
}

TEST_CASE("each possible number of a PCM passes, and the next one does not")
{
    const auto least_and_most = [](auto member, unsigned least, unsigned most) {
        alsa_options o{.channels = 9};
        for (const unsigned fine : {least, most}) {
            o.*member = fine;
            CHECK_NOTHROW(alsa::check(o));
        }
        for (const unsigned beyond : {least - 1, most + 1}) {
            o.*member = beyond;
            CHECK_THROWS_WITH_AS(alsa::check(o),
                                 doctest::Contains(fmt::format("give {} to {}", least, most).c_str()), error);
        }
    };
    least_and_most(&alsa_options::channels, 1, 1024);
    least_and_most(&alsa_options::rate, 1, 768'000);
    least_and_most(&alsa_options::period_frames, 3, 1U << 20); // 50 us at 48000 Hz
    least_and_most(&alsa_options::periods, 2, 1024);
}

TEST_CASE("a device of a card: formats in order of preference, rate and channels exact")
{
    const auto open = [](const test::fake_dac_options& d, alsa_options o) {
        test::fake_dac dac(d);
        o.pcm = "card";
        return alsa::adopt(dac.pcm(), o)->setup();
    };
    alsa_options o;
    o.channels = 8;
    CHECK(open({.formats = {SND_PCM_FORMAT_S16_LE, SND_PCM_FORMAT_FLOAT_LE}}, o).format ==
          format_kind::float32);
    CHECK(open({.formats = {SND_PCM_FORMAT_S16_LE, SND_PCM_FORMAT_S24_LE}}, o).format == format_kind::s24_4);
    CHECK(open({.formats = {SND_PCM_FORMAT_S16_LE}}, o).format == format_kind::s16);

    const failure nothing = catch_failure([&] { open({.formats = {SND_PCM_FORMAT_U8}}, o); });
    CHECK(nothing.says("refused: format"));
    CHECK(nothing.says("none that tactor plays"));
    o.channels = 65;
    o.rate = 44100;
    const failure e = catch_failure([&] { open({}, o); });
    CHECK(e.says("refused: channels, rate"));
    CHECK(e.says("channels 1 to 64, rates 48000 Hz, formats s32 float s16"));
}

TEST_CASE("a device that rounds the period reports its value")
{
    test::fake_dac dac({.least_period_bytes = 4096});
    alsa_options o;
    o.channels = 8;
    const stream_setup s = alsa::adopt(dac.pcm(), o)->setup();
    CHECK(s.period_frames == 128);
    CHECK(s.buffer_frames % s.period_frames == 0);
    CHECK(s.buffer_frames >= 2 * s.period_frames);
}

TEST_CASE("an adopted PCM is closed with its sink, and when it does not fit")
{
    test::fake_dac dac;
    alsa_options o;
    o.channels = 8;
    alsa::adopt(dac.pcm(), o).reset();
    CHECK(dac.closed());
    test::fake_dac other;
    o.channels = 65;
    CHECK_THROWS_AS(alsa::adopt(other.pcm(), o), error);
    CHECK(other.closed());
}

TEST_CASE("errors of opening come with hints")
{
    CHECK(std::string(alsa::open_error("x", -EBUSY, "").what()).find("another program") != std::string::npos);
    CHECK(std::string(alsa::open_error("x", -EACCES, "").what()).find("group audio") != std::string::npos);
    CHECK(std::string(alsa::open_error("x", -ENOENT, "").what()).find("tactor devices") != std::string::npos);
    CHECK(std::string(alsa::open_error("x", -ENODEV, "why").what()).find("why") != std::string::npos);
    CHECK(alsa::open_error("x", -EIO, "").kind() == error_kind::not_available);
}

} // namespace negotiate_test
