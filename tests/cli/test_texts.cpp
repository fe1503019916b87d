// SPDX-License-Identifier: MIT
// Texts of the tool, from values: options in errors, devices, and the final message of a run.
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "cli/devices.hpp"
#include "cli/play/play.hpp"
#include "cli/settings.hpp"
#include "studio.hpp"

namespace texts_test {

using namespace tactor;
using namespace tactor::cli;
using tactor::test::studio;

namespace {

std::string spell(const error& e)
{
    return reword_as_options(e).what();
}

std::string spell(const char* hint)
{
    return spell(error(error_kind::bad_input, "soa_s", "no", hint).with_field("soa_s"));
}

constexpr const char* tired = "it is tired";

stroke_outcome ended(const char* name, state_kind how)
{
    stroke_report r{.state = how, .frames = 24000};
    if (how != state_kind::finished)
        r.why = tired;
    return {name, 48000, r};
}

play_report run(std::vector<stroke_outcome> strokes)
{
    play_report r;
    r.device.rate = 48000;
    r.strokes = std::move(strokes);
    return r;
}

std::string said(std::vector<stroke_outcome> strokes)
{
    const auto e = find_final_error(run(std::move(strokes)));
    REQUIRE(e);
    CHECK(e->kind() == error_kind::runtime);
    return e->what();
}

} // namespace

TEST_CASE("fields and marks of the library become options and commands of the tool")
{
    CHECK(spell("lower {level_dbfs}, or gain_db") == "--soa: no (lower --level-dbfs, or gain_db)");
    CHECK(spell("{timing=fit}, or {drop_points=true} to leave places out") ==
          "--soa: no (--timing fit, or --drop-points to leave places out)");
    CHECK(spell("{fit=true| scales it, }or {outside=clamp}") ==
          "--soa: no (--fit scales it, or --outside clamp)");
    CHECK(spell("{device=hw:CARD=A}; {command:devices} lists all") ==
          "--soa: no (-D hw:CARD=A; tactor devices lists all)");
    CHECK(spell("make a plan with {command:plan}") ==
          "--soa: no (make a plan with tactor plan STROKE --format json)");
    CHECK(spell("{force=true}; {wider=true}, and the others stay silent") ==
          "--soa: no (--force; leave out the number of channels, and the others stay silent)");
    CHECK(spell("{array=none}: it has its own") == "--soa: no (leave out --array: it has its own)");
}

TEST_CASE("keys of a stroke file stay as they are there")
{
    CHECK(spell(error(error_kind::bad_input, source_place{"s.toml", 3, 1}, "no",
                      "{faces=delaunay}, {outside=clamp}")) ==
          "s.toml:3:1: no (faces = delaunay, --outside clamp)");
}

TEST_CASE("cards, other PCMs and chips have this form")
{
    CHECK(devices_text(studio()) == R"(palm-2x4 needs 8 channels at 48000 Hz.

Sound cards

  hw:CARD=DAC8x,DEV=0   <- the configured one
    snd_rpi_hifiberry_dac8x, HifiBerry DAC8x
    fits      palm-2x4
    channels  2, 4, 8
    rates     44100 48000 96000 192000 Hz
    formats   s32 s16
    period    32 to 4096 frames, 2 to 32 periods, buffer 64 to 65536

  hw:CARD=Headphones,DEV=0
    held by   pipewire (process 812), a program (process 813)
    cannot    it is busy: pipewire (process 812) plays on it (install the udev
              rules, which keep sound servers off the card Tactor)

Other PCMs

  Not tried, because opening them may start a card or a sound server (-D NAME
  tries one):
    default

GPIO chips

  pinctrl-rp1   /dev/gpiochip0, 8 lines
        0-1  -       input   free
          2  GPIO17  output  held by tactor
          3  GPIO18  input   free
        4-7  -       input   free

  no permission to open /dev/gpiochip4 (do)
)");
}

TEST_CASE("a card's built-in array is named with its option")
{
    session::device_list d = studio();
    CHECK(devices_text(d).find("preset") == std::string::npos);
    d.pcms[0].preset = "usb-7.1";
    CHECK(devices_text(d).find("    preset    usb-7.1 (--array usb-7.1)\n") != std::string::npos);
}

TEST_CASE("rates between the usual ones are a range")
{
    session::device_list d = studio();
    d.pcms[0].can->usual_rates_hz = {};
    d.pcms[0].can->rates_hz = {12345, 12346};
    CHECK(devices_text(d).find("rates     12345 to 12346 Hz\n") != std::string::npos);
    d.pcms[0].can->rates_hz = {12345, 12345};
    CHECK(devices_text(d).find("rates     12345 Hz\n") != std::string::npos);
}

TEST_CASE("JSON has the numbers, and names that are not UTF-8 do not break it")
{
    session::device_list d = studio();
    d.pcms[0].description = "K\xfcnstler";
    const std::string json = session::devices_json(d);
    for (const char* part : {"\"schema\": \"tactor-devices/1\"", "\"fits\": true", "\"fits\": null",
                             "\"pid\": 812", "\"consumer\": \"tactor\"", "\"label\": \"pinctrl-rp1\""})
        CHECK_MESSAGE(json.find(part) != std::string::npos, part);
}

TEST_CASE("a run whose strokes all finished has no message")
{
    CHECK_FALSE(find_final_error(run({ended("a", state_kind::finished), ended("b", state_kind::finished)})));
}

TEST_CASE("one stroke that did not finish is an error, wherever it is")
{
    const stroke_outcome whole = ended("a", state_kind::finished);
    const stroke_outcome cut = ended("b", state_kind::interrupted);
    CHECK(said({cut}) == "b: interrupted after 0.500 s: it is tired");
    CHECK(said({cut, whole}) == said({cut}));
    CHECK(said({whole, cut}) == said({cut}));
    CHECK(said({ended("b", state_kind::cancelled), whole}) == "b: cancelled after 0.500 s: it is tired");
}

TEST_CASE("of several unfinished strokes the last is named, with their number")
{
    CHECK(said({ended("a", state_kind::interrupted), ended("b", state_kind::finished),
                ended("c", state_kind::interrupted)}) ==
          "c: interrupted after 0.500 s: it is tired; 2 of 3 strokes did not finish");
    CHECK(said({ended("a", state_kind::interrupted), {"b"}}) ==
          "b: not played; 2 of 2 strokes did not finish");
}

} // namespace texts_test
