// SPDX-License-Identifier: MIT
// The player on null and file PCMs, which it paces itself.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "folder.hpp"
#include "player_support.hpp"
#include "scores.hpp"

namespace player_clockless_test {

using namespace tactor;
using namespace tactor::test;

namespace {

// Returns options for the PCM called t of a configuration.
alsa_options configured(const std::string& text, format_kind f = format_kind::s32)
{
    alsa_options o = nine(f);
    o.pcm.assign(1, 't');
    o.config_text = text;
    return o;
}

std::vector<std::byte> read_file(const std::filesystem::path& p)
{
    std::ifstream in(p, std::ios::binary);
    const std::vector<char> raw{std::istreambuf_iterator<char>(in), {}};
    std::vector<std::byte> bytes(raw.size());
    std::transform(raw.begin(), raw.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
    return bytes;
}

std::size_t first_sound(const std::vector<std::byte>& all)
{
    return static_cast<std::size_t>(
        std::find_if(all.begin(), all.end(), [](std::byte b) { return b != std::byte{0}; }) - all.begin());
}

} // namespace

TEST_CASE("a file PCM receives silence, the renderer's bytes without a gap, silence")
{
    for (const format_kind f : {format_kind::s32, format_kind::s16}) {
        CAPTURE(to_string(f));
        const folder dir;
        const std::filesystem::path file = dir / "out.raw";
        const alsa_options o = configured(
            fmt::format("pcm.n {{ type null }} pcm.t {{ type file slave.pcm n file \"{}\" format raw }}",
                        file.string()),
            f);
        const score a = random_score(5, 6);
        const score b = random_score(6, 2);
        {
            player p(open_alsa(o), palm(), patient());
            CHECK_FALSE(p.setup().has_clock);
            const stroke_id id = p.submit(a);
            REQUIRE(p.wait(id));
            const auto r = p.wait(p.submit(b));
            REQUIRE(r);
            CHECK(r->state == state_kind::finished);
            p.stop();
            CHECK(p.stats().xruns == 0);
        }
        const std::size_t frame = 9 * sample_bytes(f);
        std::vector<std::byte> all = read_file(file);
        CHECK(all.size() % frame == 0);
        for (const score& s : {a, b}) {
            const std::vector<std::byte> want = rendered(s, f);
            // The renderer's first frame is the zero of a sine.
            const std::size_t from = first_sound(all) / frame * frame - first_sound(want) / frame * frame;
            REQUIRE(from + want.size() <= all.size());
            CHECK(part(all, from, want.size()) == want);
            all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(from + want.size()));
        }
        CHECK(first_sound(all) == all.size());
    }
}

TEST_CASE("a file that cannot be written ends the stream with the reason")
{
    player p(open_alsa(configured(
                 "pcm.n { type null } pcm.t { type file slave.pcm n file \"/dev/full\" format raw }")),
             palm());
    // It may fail before or after the stroke begins.
    std::string said;
    try {
        const auto r = p.wait(p.submit(tone(60.0)));
        REQUIRE(r);
        CHECK(r->state == state_kind::interrupted);
        said = r->why;
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::runtime);
        said = e.what();
    }
    CHECK(said.find("the device failed: Input/output error") != std::string::npos);
}

TEST_CASE("null paces a stroke in real time, multi of nulls too")
{
    const std::string multi =
        "pcm.n { type null }\n"
        "pcm.t { type multi slaves.a { pcm n channels 8 } slaves.b { pcm n channels 1 }\n"
        "bindings { 0 { slave a channel 0 } 1 { slave a channel 1 } 2 { slave a channel 2 }\n"
        "3 { slave a channel 3 } 4 { slave a channel 4 } 5 { slave a channel 5 }\n"
        "6 { slave a channel 6 } 7 { slave a channel 7 } 8 { slave b channel 0 } } }\n";
    for (const bool many : {false, true}) {
        CAPTURE(many);
        player p(open_alsa(many ? configured(multi) : nine()), palm(), patient());
        const auto begun = std::chrono::steady_clock::now();
        const auto r = p.wait(p.submit(tone(0.1)));
        REQUIRE(r);
        CHECK(r->state == state_kind::finished);
        CHECK(std::chrono::steady_clock::now() - begun >= std::chrono::milliseconds(100));
        CHECK(p.stats().xruns == 0);
    }
}

TEST_CASE("a stream with fewer channels than the array is refused with the tactor that would be mute")
{
    const array palm = preset_array("palm-3x3");
    try {
        const player p(open_alsa({.pcm = "null", .channels = 4}), palm);
        FAIL("it opened");
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::bad_input);
        CHECK(std::string(e.what()) == "player: tactor 4 of palm-3x3 is on channel 4, but the stream has 4 "
                                       "channels (open it with 9 channels; they count from 0)");
    }
    CHECK_NOTHROW(player(open_alsa({.pcm = "null", .channels = 9}), palm));
    CHECK_NOTHROW(player(open_alsa({.pcm = "null", .channels = 16}), palm));
}

} // namespace player_clockless_test
