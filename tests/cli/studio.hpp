// SPDX-License-Identifier: MIT
// Devices of a machine with cards, chips and trouble.
#pragma once

#include <utility>

#include "session/device.hpp"

namespace tactor::test {

inline session::device_list studio()
{
    session::device_list d;
    d.array_name = "palm-2x4";
    d.wanted = {.pcm = "hw:DAC8x", .channels = 8};
    d.pcm_is_configured = true;
    d.pcms = {{.name = "hw:CARD=DAC8x,DEV=0",
               .description = "snd_rpi_hifiberry_dac8x, HifiBerry DAC8x",
               .hardware = true,
               .wanted = true,
               .opened = true,
               .can = pcm_abilities{.channels = {{2, 2}, {4, 4}, {8, 8}},
                                    .rates_hz = {44100, 192000},
                                    .usual_rates_hz = {44100, 48000, 96000, 192000},
                                    .formats = {format_kind::s32, format_kind::s16},
                                    .period_frames = {32, 4096},
                                    .periods = {2, 32},
                                    .buffer_frames = {64, 65536}}},
              {.name = "hw:CARD=Headphones,DEV=0",
               .hardware = true,
               .error = "it is busy: pipewire (process 812) plays on it (install the udev rules, "
                        "which keep sound servers off the card Tactor)",
               .holders = {{812, "pipewire"}, {813, ""}}},
              {.name = "default", .error = "not tried", .tried = false}};
    gpio_chip_info header{.path = "/dev/gpiochip0", .name = "gpiochip0", .label = "pinctrl-rp1"};
    for (unsigned i = 0; i < 8; ++i)
        header.lines.push_back({.offset = i});
    header.lines[2] = {.offset = 2, .name = "GPIO17", .consumer = "tactor", .output = true};
    header.lines[3] = {.offset = 3, .name = "GPIO18", .consumer = "", .output = false};
    d.chips = {std::move(header),
               {.path = "/dev/gpiochip4", .error = "no permission to open /dev/gpiochip4 (do)"}};
    return d;
}

} // namespace tactor::test
