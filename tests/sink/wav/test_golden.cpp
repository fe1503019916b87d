// SPDX-License-Identifier: MIT
// WAV files byte by byte.
#include <clocale>
#include <cstdint>
#include <locale>
#include <string>

#include <doctest/doctest.h>

#include <tactor/plan.hpp>
#include <tactor/render.hpp>
#include <tactor/stroke.hpp>

#include "../../synth/pieces.hpp"
#include "folder.hpp"
#include "sink/wav/wav.hpp"

namespace golden_test {

using namespace tactor;
using wav::container;

namespace {

struct golden {
    algorithm_kind algorithm;
    phase_kind phase;
    format_kind format;
    std::uint64_t digest;
};

const golden all_golden[] = {
    // Before the carrier ran through the stroke, these were the defaults.
    {algorithm_kind::park2016, phase_kind::burst, format_kind::float32, 0xc946580a297d916aU},
    {algorithm_kind::park2016, phase_kind::burst, format_kind::s16, 0x8af13b4bca8b7500U},
    {algorithm_kind::park2016, phase_kind::burst, format_kind::s24_3, 0x2103b24f6d27edcbU},
    {algorithm_kind::park2016, phase_kind::burst, format_kind::s32, 0xf95615bd3d77b174U},
    {algorithm_kind::tactile_brush, phase_kind::burst, format_kind::float32, 0xcaa84436c5e4fe25U},
    {algorithm_kind::tactile_brush, phase_kind::burst, format_kind::s16, 0x77551240e3a72c21U},
    {algorithm_kind::tactile_brush, phase_kind::burst, format_kind::s24_3, 0xa10a3bd23ecf835bU},
    {algorithm_kind::tactile_brush, phase_kind::burst, format_kind::s32, 0xe5959743f9673606U},
    {algorithm_kind::continuous, phase_kind::burst, format_kind::float32, 0xa1b19d0e79f0cbcbU},
    {algorithm_kind::continuous, phase_kind::burst, format_kind::s16, 0x8fb1701e87184617U},
    {algorithm_kind::continuous, phase_kind::burst, format_kind::s24_3, 0x9c0b3468dd63677bU},
    {algorithm_kind::continuous, phase_kind::burst, format_kind::s32, 0xd68411e3eab73468U},
    // The default.
    {algorithm_kind::park2016, phase_kind::stroke, format_kind::float32, 0x1b9237ef876a1639U},
    {algorithm_kind::park2016, phase_kind::stroke, format_kind::s16, 0xbbaf86334e325f68U},
    {algorithm_kind::park2016, phase_kind::stroke, format_kind::s24_3, 0xad37ca6f73a37367U},
    {algorithm_kind::park2016, phase_kind::stroke, format_kind::s32, 0xb2a65538496e3964U},
    {algorithm_kind::tactile_brush, phase_kind::stroke, format_kind::float32, 0xdaf734485f4d666bU},
    {algorithm_kind::tactile_brush, phase_kind::stroke, format_kind::s16, 0xbda9645a0e67dc51U},
    {algorithm_kind::tactile_brush, phase_kind::stroke, format_kind::s24_3, 0x966dd564a5aad884U},
    {algorithm_kind::tactile_brush, phase_kind::stroke, format_kind::s32, 0x3431fbe00f8d7528U},
    {algorithm_kind::continuous, phase_kind::stroke, format_kind::float32, 0xa1b19d0e79f0cbcbU},
    {algorithm_kind::continuous, phase_kind::stroke, format_kind::s16, 0x8fb1701e87184617U},
    {algorithm_kind::continuous, phase_kind::stroke, format_kind::s24_3, 0x9c0b3468dd63677bU},
    {algorithm_kind::continuous, phase_kind::stroke, format_kind::s32, 0xd68411e3eab73468U},
};

std::string render_file(const folder& dir, algorithm_kind algorithm, format_kind f,
                        const render_options& sound = {})
{
    const array a = preset_array("palm-3x3");
    plan_options o{.algorithm = algorithm};
    // Motion 1 starts 4 mm below a row of the grid, and crosses one twice in less time than two bursts need.
    o.snap = true;
    o.drop_points = true;
    const score s(a, {{make_plan(a, preset_stroke("park2016-1"), o), {}}}, sound);
    write_wav(s, f, dir / "a.wav");
    return dir.bytes("a.wav");
}

std::uint64_t hash_bytes(const std::string& bytes)
{
    return pieces::digest(std::as_bytes(std::span(bytes)));
}

struct comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

/// A comma as decimal point, in C where the system has such a locale and in C++ always.
class comma_locale {
public:
    comma_locale() : before_(std::locale::global(std::locale(std::locale(), new comma)))
    {
        for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "de_DE", "fr_FR"})
            if (std::setlocale(LC_ALL, name) != nullptr)
                break;
    }
    ~comma_locale()
    {
        std::setlocale(LC_ALL, "C");
        std::locale::global(before_);
    }
    comma_locale(const comma_locale&) = delete;
    comma_locale& operator=(const comma_locale&) = delete;

private:
    std::locale before_;
};

std::uint64_t number(const std::string& s, std::size_t at, unsigned bytes)
{
    std::uint64_t n = 0;
    for (unsigned i = bytes; i-- > 0;)
        n = n << 8U | static_cast<unsigned char>(s.at(at + i));
    return n;
}

} // namespace

TEST_CASE("the bytes of park2016-1 are those of the last release, in any locale")
{
    const folder dir;
    for (const golden& g : all_golden) {
        CAPTURE(std::string(to_string(g.algorithm)));
        CAPTURE(std::string(to_string(g.format)));
        CAPTURE(std::string(to_string(g.phase)));
        render_options sound{.phase = g.phase};
        CHECK(hash_bytes(render_file(dir, g.algorithm, g.format, sound)) == g.digest);
        const comma_locale with_comma;
        CHECK(hash_bytes(render_file(dir, g.algorithm, g.format, sound)) == g.digest);
    }
}

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

} // namespace golden_test
