// SPDX-License-Identifier: MIT
// Set-ups that are negotiated, and the device channels that a PCM's channels reach.
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "fake_dac.hpp"
#include "folder.hpp"
#include "sink/alsa/error_text.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/pcm_sink.hpp"
#include "sink/alsa/route.hpp"

namespace negotiate_test {

using namespace tactor;
using channels = std::vector<std::vector<unsigned>>;

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
    alsa_options o{.pcm = "t", .channels = channels, .config_text = text};
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
    return catch_failure([&] { return open_alsa(o); });
}

stream_wiring wired(const std::string& text, const std::string& name, unsigned n)
{
    return alsa::find_wiring(alsa::read_configuration(text).get(), name, n, n);
}

constexpr const char* definitions = R"(
pcm.hw { @args [ CARD DEV ] @args.CARD { type string default "0" } @args.DEV { type integer default 0 } type hw card $CARD device $DEV }
pcm.plug { @args [ SLAVE ] @args.SLAVE { type string } type plug slave.pcm $SLAVE }
pcm.null { type null }
pcm.swapped { type route slave { pcm "hw:0" channels 4 } ttable { 0.1 1 1.0 1 2.2 0.5 3.3 0 } }
pcm.above { type plug slave.pcm "swapped" }
pcm.again { type route slave.pcm "swapped" ttable { 0.1 1 1.0 1 2.3 1 3.2 1 } }
pcm.tabled { type plug slave.pcm "hw:0" ttable { 0.0 1 1.0 1 } }
pcm.mixed { type dmix ipc_key 1 slave { pcm "hw:Tactor" channels 8 } bindings { 0 7 1 8 } }
pcm.shared { type dshare ipc_key 1 slave "eight" bindings { 0 6 1 6 2 5 } }
pcm_slave.eight { pcm "hw:0" channels 8 }
pcm.unbound { type dmix ipc_key 1 slave "eight" }
pcm.two { type multi slaves { a { pcm "hw:0" channels 2 } b { pcm "hw:1" channels 2 } }
          bindings { 0 { slave a channel 1 } 1 { slave b channel 0 } 3 { slave b channel 1 } 4 { slave c channel 0 } } }
pcm.same { type multi slaves { a { pcm "mixed" channels 2 } b { pcm "mixed" channels 2 } }
           bindings { 0 { slave a channel 0 } 1 { slave b channel 0 } } }
pcm.both { type asym playback.pcm "swapped" capture.pcm "tabled" }
pcm.alias "swapped"
pcm.over { type softvol slave.pcm { type rate slave { pcm { type file file "/dev/null" slave.pcm "swapped" } rate 48000 } } }
pcm.front { type route slave.pcm "hw:0" ttable { 0.FL 1 1.FR 1 } }
pcm.odd { type ladspa slave.pcm "hw:0" }
pcm.desk { type plug slave.pcm { type pulse } }
pcm.round { type plug slave.pcm "round" }
pcm.wide { type multi slaves { a { pcm "wide" channels 1 } b { pcm "wide" channels 1 } c { pcm "wide" channels 1 } }
           bindings.0 { slave a channel 0 } }
pcm.typeless { slave.pcm "hw:0" }
pcm.nowhere { type plug slave.pcm "none" }
pcm.slaveless { type plug }
pcm.huge { type route slave { pcm "hw:0" channels 2000000000 } ttable { 0.1 1 999999999.0 1 1.99999 1 } }
)";

stream_wiring defined(const std::string& name, unsigned n)
{
    return wired(definitions, name, n);
}

struct plugin {
    std::string_view before; ///< of the slave's name in its definition
    std::string_view after;

    std::string define(const std::string& name, const std::string& slave) const
    {
        return fmt::format("pcm.{} {{ {}{}{} }}\n", name, before, slave, after);
    }
};

// Plays a frame for each channel with a sample in that channel only; returns the samples of the devices that
// it reached.
channels heard(const alsa_options& o, const folder& here, const std::vector<std::string>& files)
{
    {
        const alsa::library_messages silent;
        const alsa::configuration top = alsa::read_configuration(o.config_text);
        const alsa::handle h = alsa::open(o, top.get());
        static_cast<void>(alsa::negotiate(h.get(), o));
        REQUIRE(snd_pcm_prepare(h.get()) >= 0);
        std::vector<std::int16_t> frames(std::size_t{o.channels} * o.channels);
        for (unsigned c = 0; c < o.channels; ++c)
            frames[c * (o.channels + 1)] = 8000;
        REQUIRE(snd_pcm_writei(h.get(), frames.data(), o.channels) == static_cast<long>(o.channels));
    }
    channels all(o.channels);
    for (std::size_t f = 0; f < files.size(); ++f) {
        const std::string bytes = here.bytes(files[f]);
        const std::size_t width = bytes.size() / o.channels / o.channels;
        for (unsigned c = 0; c < o.channels && width > 0; ++c)
            for (unsigned k = 0; k < o.channels; ++k) {
                const std::string sample = bytes.substr((c * o.channels + k) * width, width);
                if (sample != std::string(width, '\0'))
                    all[c].push_back(static_cast<unsigned>(f) * 1024 + k);
            }
    }
    return all;
}

} // namespace

TEST_CASE("null takes the request, in the first format of the preference")
{
    alsa_options o{.channels = 9};
    const auto s = open_alsa(o);
    CHECK(s->setup().name == "null");
    CHECK(s->setup().channels == 9);
    CHECK(s->setup().rate == 48000);
    CHECK(s->setup().format == format_kind::s32);
    CHECK(s->setup().period_frames == 96);
    CHECK(s->setup().buffer_frames == 288);
}

TEST_CASE("a device of exactly eight channels takes eight, and says so when asked for nine")
{
    CHECK(open_alsa(configured(eight_channels(), 8))->setup().channels == 8);
    const failure e = failure_of_open(configured(eight_channels(), 9));
    CHECK(e.kind == error_kind::not_available);
    CHECK(e.says("PCM \"t\": it cannot play 9 channels at 48000 Hz in s32, float"));
    CHECK(e.says("unsupported number of channels"));
    CHECK(e.says("channels: 8; rate in Hz: any; formats: s32 float"));
}

TEST_CASE("the fewest channels that hold the stream are taken")
{
    alsa_options o = configured(eight_channels(), 5);
    CHECK(failure_of_open(o).says("unsupported number of channels"));
    o.wider = true;
    const auto s = open_alsa(o);
    CHECK(s->setup().channels == 5);
    CHECK(s->setup().device_channels == 8);
    CHECK(s->setup().frame_bytes() == 20);
    o.channels = 9;
    CHECK(failure_of_open(o).says("unsupported number of channels"));
    o = {};
    o.channels = 9;
    o.wider = true;
    CHECK(open_alsa(o)->setup().device_channels == 9);
}

TEST_CASE("a card of 2, 8 or 16 channels and no other takes 16 for nine")
{
    test::fake_dac dac({.channel_counts = {2, 8, 16}});
    alsa_options o{.channels = 9, .wider = true};
    CHECK(alsa::adopt(dac.pcm(), o)->setup().device_channels == 16);
}

TEST_CASE("channels beyond the stream's are silent, whatever was in their memory")
{
    bool planar = false;
    SUBCASE("interleaved")
    {
    }
    SUBCASE("planar")
    {
        planar = true;
    }
    test::fake_dac dac({.least_channels = 16, .most_channels = 16, .planar = planar});
    alsa_options o{.channels = 3, .wider = true, .format = format_kind::s16};
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

TEST_CASE("a planar card gets each sample of each format")
{
    using pair = std::pair<format_kind, snd_pcm_format_t>;
    for (const auto& [format, its] :
         {pair(format_kind::s16, SND_PCM_FORMAT_S16_LE), pair(format_kind::s24_3, SND_PCM_FORMAT_S24_3LE),
          pair(format_kind::s32, SND_PCM_FORMAT_S32_LE),
          pair(format_kind::float32, SND_PCM_FORMAT_FLOAT_LE)}) {
        CAPTURE(to_string(format));
        test::fake_dac dac({.formats = {its}, .planar = true});
        const auto s = alsa::adopt(dac.pcm(), {.channels = 9, .format = format});
        CHECK(s->setup().planar);
        REQUIRE(s->prepare() == io_kind::ok);
        std::vector<std::byte> frames(s->setup().buffer_frames * s->setup().frame_bytes());
        for (std::size_t i = 0; i < frames.size(); ++i)
            frames[i] = static_cast<std::byte>(i * 7 % 251);
        const std::span<const std::byte> all = frames;
        const std::size_t first = 101 * s->setup().frame_bytes();
        REQUIRE(s->write(all.first(first)).frames == 101);
        REQUIRE(s->start() == io_kind::ok);
        REQUIRE(s->write(all.subspan(first)).status == io_kind::ok);
        CHECK(dac.captured() == frames);
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
    CHECK(e.says("unsupported format"));
    CHECK(e.says("use channels: any; rate in Hz: any; formats: s32"));
}

TEST_CASE("plug neither resamples nor mixes channels behind the user's back")
{
    const failure e = failure_of_open(configured(stereo_44100));
    CHECK(e.kind == error_kind::not_available);
    CHECK(e.says("unsupported number of channels, rate"));
    CHECK(e.says("channels: 2; rate in Hz: 44100"));
    alsa_options o = configured(stereo_44100, 2);
    o.rate = 44100;
    CHECK(open_alsa(o)->setup().rate == 44100);
}

TEST_CASE("an unknown PCM is reported as unknown")
{
    for (const char* name : {"no-such-pcm", "hw:CARD=NoSuchCard", "hw:31", "", "null:1,2,3,4"}) {
        CAPTURE(name);
        alsa_options o{.pcm = name, .channels = 9};
        const failure e = failure_of_open(o);
        CHECK(e.kind == error_kind::not_available);
        CHECK(e.says("PCM \"" + std::string(name) + "\": "));
        CHECK(e.says("tactor devices"));
    }
    alsa_options o{.pcm = "no-such-pcm", .channels = 9};
    CHECK(failure_of_open(o).says("no such PCM"));
}

TEST_CASE("opening prints nothing")
{
    std::FILE* catcher = std::tmpfile();
    REQUIRE(catcher != nullptr);
    const int before = ::dup(STDERR_FILENO);
    ::dup2(::fileno(catcher), STDERR_FILENO);
    alsa_options o{.pcm = "hw:CARD=NoSuchCard", .channels = 1};
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

TEST_CASE("each possible number of a PCM passes, and the next one is bad input")
{
    const auto least_and_most = [](auto member, unsigned least, unsigned most, unsigned rate = 48'000) {
        alsa_options o{.channels = 9, .rate = rate};
        for (const unsigned fine : {least, most}) {
            o.*member = fine;
            CHECK_NOTHROW(alsa::check(o));
        }
        for (const unsigned beyond : {least - 1, most + 1}) {
            o.*member = beyond;
            const failure e = catch_failure([&] { alsa::check(o); });
            CHECK(e.kind == error_kind::bad_input);
            CHECK(e.says(fmt::format("give {} to {}", least, most)));
        }
    };
    least_and_most(&alsa_options::channels, 1, 1024);
    least_and_most(&alsa_options::periods, 2, 1024);
    for (const auto& [rate, least] : {std::pair(8000U, 1U), std::pair(48'000U, 3U), std::pair(60'000U, 3U),
                                      std::pair(60'001U, 4U), std::pair(768'000U, 39U)}) // 50 us
        least_and_most(&alsa_options::period_frames, least, 1U << 20, rate);
    for (const unsigned rate : {0U, 768'001U, 4'000'000'000U})
        CHECK(failure_of_open({.channels = 9, .rate = rate}).kind == error_kind::bad_input);
}

TEST_CASE("a device of a card: formats in order of preference, rate and channels exact")
{
    const auto open = [](const test::fake_dac_options& d, alsa_options o) {
        test::fake_dac dac(d);
        o.pcm = "card";
        return alsa::adopt(dac.pcm(), o)->setup();
    };
    alsa_options o{.channels = 8};
    CHECK(open({.formats = {SND_PCM_FORMAT_S16_LE, SND_PCM_FORMAT_FLOAT_LE}}, o).format ==
          format_kind::float32);
    CHECK(open({.formats = {SND_PCM_FORMAT_S16_LE, SND_PCM_FORMAT_S24_LE}}, o).format == format_kind::s24_4);
    CHECK(open({.formats = {SND_PCM_FORMAT_S16_LE}}, o).format == format_kind::s16);

    const failure nothing = catch_failure([&] { open({.formats = {SND_PCM_FORMAT_U8}}, o); });
    CHECK(nothing.says("unsupported format"));
    CHECK(nothing.says("none that tactor plays"));
    o.channels = 65;
    o.rate = 44100;
    const failure e = catch_failure([&] { open({}, o); });
    CHECK(e.says("unsupported number of channels, rate"));
    CHECK(e.says("channels: 1 to 64; rate in Hz: 48000; formats: s32 float s16"));
}

TEST_CASE("a device that rounds the period reports its value")
{
    test::fake_dac dac({.least_period_bytes = 4096});
    alsa_options o{.channels = 8};
    const stream_setup s = alsa::adopt(dac.pcm(), o)->setup();
    CHECK(s.period_frames == 128);
    CHECK(s.buffer_frames % s.period_frames == 0);
    CHECK(s.buffer_frames >= 2 * s.period_frames);
}

TEST_CASE("an adopted PCM is closed with its sink, and when it does not fit")
{
    test::fake_dac dac;
    alsa_options o{.channels = 8};
    alsa::adopt(dac.pcm(), o).reset();
    CHECK(dac.closed());
    test::fake_dac other;
    o.channels = 65;
    CHECK_THROWS_AS(alsa::adopt(other.pcm(), o), error);
    CHECK(other.closed());
}

TEST_CASE("a plugin that passes its channels on changes nothing")
{
    for (const char* name : {"null", "hw:0", "hw:CARD=Tactor,DEV=3", "hw:0,777767777773", "plug:null",
                             "plug:'hw:0,1'", "unbound"}) {
        CAPTURE(name);
        const stream_wiring w = defined(name, 8);
        CHECK(w.outputs.empty());
        CHECK(w.hidden_by == "");
    }
}

TEST_CASE("tables and bindings define the reached channels of the device, through any plugins between")
{
    const channels swapped{{1}, {0}, {2}, {}};
    for (const char* name : {"swapped", "above", "plug:swapped", "both", "alias", "over"}) {
        CAPTURE(name);
        CHECK(defined(name, 4).outputs == swapped);
        CHECK(defined(name, 4).hidden_by == "");
    }
    CHECK(defined("swapped", 6).outputs == channels{{1}, {0}, {2}, {}, {}, {}});
    CHECK(defined("swapped", 2).outputs == channels{{1}, {0}});
    CHECK(defined("again", 4).outputs.empty() == false);
    CHECK(defined("again", 4).outputs == channels{{0}, {1}, {}, {2}});
    CHECK(defined("tabled", 2).outputs == channels{{0}, {0}});
    CHECK(defined("mixed", 3).outputs == channels{{7}, {}, {}});
    CHECK(defined("shared", 3).outputs == channels{{6}, {6}, {5}});
    CHECK(defined("two", 5).outputs == channels{{1}, {1024}, {}, {1025}, {}});
    CHECK(defined("same", 2).outputs == channels{{7}, {7}}); // one device on two ways
}

TEST_CASE("tables change levels, and below -60 dB nothing is reached")
{
    const auto through = [](const std::string& table) {
        return wired("pcm.n { type null } pcm.h { type route slave.pcm n ttable { 0.0 0.5 1.1 1 } }"
                     "pcm.t { type route slave.pcm h ttable { " +
                         table + " } }",
                     "t", 2);
    };
    using gains = std::vector<std::vector<double>>;
    CHECK(through("0.0 1 1.1 1").gains == gains{{0.5}, {1.0}});
    CHECK(through("0.0 2 1.1 1").outputs.empty()); // back to 1
    CHECK(through("0.0 -0.1 1.1 4").gains == gains{{-0.05}, {4.0}});
    CHECK(through("0.0 1 0.1 0.5 1.1 1").gains == gains{{0.5, 0.5}, {1.0}});
    CHECK(through("0.0 0.001 1.1 0.001").outputs == channels{{}, {1}});
    CHECK(through("0.0 0.001 1.1 0.001").gains == gains{{}, {0.001}});
    const stream_wiring soft =
        wired("pcm.n { type null } pcm.t { type softvol slave.pcm n control { name x card 0 } }", "t", 2);
    CHECK(soft.outputs.empty());
    CHECK(soft.level_by == "type softvol");
}

TEST_CASE("unknown definitions are reported, and give no channels")
{
    const auto hidden = [](const std::string& name) {
        const stream_wiring w = defined(name, 4);
        CHECK(w.outputs.empty());
        return w.hidden_by;
    };
    CHECK(hidden("odd") == "type ladspa");
    CHECK(hidden("desk") == "type pulse");
    CHECK(hidden("front") == "type route to a channel FL");
    CHECK(hidden("typeless") == "a definition without a type");
    CHECK(hidden("nowhere") == "none, which is not defined");
    CHECK(hidden("slaveless") == "a slave that is not defined");
}

TEST_CASE("definitions that lead to themselves, or to more than anyone has, end")
{
    CHECK(defined("round", 9).hidden_by == "too many definitions");
    CHECK(defined("wide", 9).hidden_by == "too many definitions");
    CHECK(defined("huge", 2).outputs == channels{{1}, {}});
}

TEST_CASE("the largest factor after a table counts, not only the one at the device")
{
    const std::string half =
        "pcm.n { type null }\npcm.half { type route slave.pcm n ttable { 0.0 0.5 1.1 0.5 } }\n";
    const auto most = [&](const std::string& table) {
        return wired(half + "pcm.t { type route slave.pcm half ttable { " + table + " } }", "t", 2).most_gain;
    };
    CHECK(most("0.0 2 1.1 1") == 2.0);
    CHECK(most("0.0 1 1.1 -4") == 4.0);
    CHECK(most("0.0 1 1.1 0.5") == 1.0);
    CHECK(most("0.0 0.5 1.1 0.5 2.2 4") == 1.0); // of a channel that the stream does not have
    // Two ways to one channel add up.
    CHECK(wired(half + "pcm.two { type route slave.pcm half ttable { 0.0 0.9 1.0 0.9 } }\n"
                       "pcm.t { type route slave { pcm two channels 2 } ttable { 0.0 1 0.1 1 } }",
                "t", 1)
              .most_gain == doctest::Approx(1.8));
    CHECK(wired(half + "pcm.t { type plug slave.pcm half ttable { 0.0 2 1.1 2 } }", "t", 2).outputs.empty());
}

TEST_CASE("the wiring of tables, bindings and copies upon each other is that of libasound")
{
    constexpr plugin route{"type route slave.pcm ", " ttable { 0.1 1 0.3 0.5 1.0 1 2.2 0.5 3.3 0 }"};
    constexpr plugin plug{"type plug slave.pcm ", " ttable { 0.0 1 1.0 1 2.3 1 3.1 0.5 }"};
    constexpr plugin copy{"type copy slave.pcm ", ""};
    constexpr plugin multi{"type multi slaves { a { pcm ",
                           " channels 4 } b { pcm second channels 4 } } bindings { 0 { slave b channel 2 } 1 "
                           "{ slave a channel 3 } "
                           "2 { slave a channel 0 } 3 { slave b channel 1 } }"};
    for (const plugin& outer : {route, plug, copy})
        for (const plugin& middle : {route, plug, copy, multi})
            for (const plugin& inner : {route, plug, copy}) {
                const folder here;
                const auto device = [&](const char* name) {
                    return fmt::format("pcm.{} {{ type file slave.pcm null file \"{}\" format raw }}\n", name,
                                       (here / name).string());
                };
                const alsa_options o{.pcm = "t",
                                     .channels = 4,
                                     .format = format_kind::s16,
                                     .config_text = "pcm.null { type null }\n" + device("first") +
                                                    device("second") + inner.define("i", "first") +
                                                    middle.define("m", "i") + outer.define("t", "m")};
                INFO(o.config_text);
                std::vector<std::string> files{(here / "first").string()};
                if (middle.before == multi.before)
                    files.push_back((here / "second").string());
                const stream_wiring w = wired(o.config_text, o.pcm, 4);
                CHECK(w.hidden_by == "");
                const channels straight{{0}, {1}, {2}, {3}};
                CHECK(heard(o, here, files) == (w.outputs.empty() ? straight : w.outputs));
            }
}

} // namespace negotiate_test
