// SPDX-License-Identifier: MIT
// Output of `devices` for machines with cards and chips.
#include <doctest/doctest.h>

#include "cli/devices.hpp"

namespace devices_text_test {

using namespace tactor;
using namespace tactor::cli;

namespace {

gpio_chip_info header_chip()
{
    gpio_chip_info c{.path = "/dev/gpiochip0", .name = "gpiochip0", .label = "pinctrl-rp1"};
    for (unsigned i = 0; i < 8; ++i)
        c.lines.push_back({.offset = i});
    c.lines[2] = {.offset = 2, .name = "GPIO17", .consumer = "tactor", .output = true};
    c.lines[3] = {.offset = 3, .name = "GPIO18", .consumer = "", .output = false};
    return c;
}

session::device_list studio()
{
    session::device_list d;
    d.array_name = "palm-2x4";
    d.wanted = {.pcm = "hw:DAC8x", .channels = 8};
    d.pcm_is_configured = true;
    const pcm_abilities can{.channels = {{2, 2}, {4, 4}, {8, 8}},
                            .rates_hz = {44100, 192000},
                            .usual_rates_hz = {44100, 48000, 96000, 192000},
                            .formats = {format_kind::s32, format_kind::s16},
                            .period_frames = {32, 4096},
                            .periods = {2, 32},
                            .buffer_frames = {64, 65536}};
    d.pcms = {{.name = "hw:CARD=DAC8x,DEV=0",
               .description = "snd_rpi_hifiberry_dac8x, HifiBerry DAC8x",
               .hardware = true,
               .wanted = true,
               .opened = true,
               .can = can},
              {.name = "hw:CARD=Headphones,DEV=0",
               .hardware = true,
               .error = "it is busy: pipewire (process 812) plays on it (a sound server has it: the udev "
                        "rules keep those off the card Tactor)",
               .holders = {{812, "pipewire"}, {813, ""}}},
              {.name = "default", .error = "not tried", .tried = false}};
    d.chips = {header_chip(),
               {.path = "/dev/gpiochip4", .error = "no permission to open /dev/gpiochip4 (do)"}};
    return d;
}

} // namespace

TEST_CASE("cards, other PCMs and chips have this form")
{
    CHECK(devices_text(studio()) == R"(palm-2x4 needs 8 channels at 48000 Hz.

Sound cards

  hw:CARD=DAC8x,DEV=0   <- the one that is configured
    snd_rpi_hifiberry_dac8x, HifiBerry DAC8x
    fits      palm-2x4
    channels  2, 4, 8
    rates     44100 48000 96000 192000 Hz
    formats   s32 s16
    period    32 to 4096 frames, 2 to 32 periods, buffer 64 to 65536

  hw:CARD=Headphones,DEV=0
    held by   pipewire (process 812), a program (process 813)
    cannot    it is busy: pipewire (process 812) plays on it (a sound server
              has it: the udev rules keep those off the card Tactor)

Other PCMs

  Not tried, since to open them may start a card or a sound server (-D NAME
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

} // namespace devices_text_test
