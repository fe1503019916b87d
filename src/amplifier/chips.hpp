// SPDX-License-Identifier: MIT
/// \file
/// The chips of this machine, and which line of which chip a user means.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace tactor::gpio {

/// A line that exists: chips[chip].info.lines[offset].
struct line_place {
    std::size_t chip = 0;
    unsigned offset = 0;
};

/// Finds the line that a user means. Pure: the chips are values. A chip is named by path or by label, a line
/// by name or by offset; without a chip the name is looked for on all.
/// \throws error: not_available, with what there is instead; bad_input without a name and without chip and
///         offset.
line_place find_line(std::span<const chip> chips, const gpio_line_name& wanted);

/// Device nodes gpiochipN in a folder, by number. Links are left out: Raspberry Pi kernels keep gpiochip4
/// as a second name of gpiochip0.
std::vector<std::string> chip_paths(const std::filesystem::path& folder = "/dev");

/// Returns why a path is no GPIO chip, as an errno; 0: it is one. Opens nothing: a pipe would wait, and a
/// watchdog would start.
int not_a_chip(const std::string& path);

/// Name of the group that owns a file, "gpio" where that cannot be found out.
std::string group_of(const std::string& path);

/// Looks the line up among the chips that there are now. Throws as find_line() does.
gpio_line_place look_up(const gpio_line_name& wanted);

/// What is to be opened.
struct located_line {
    std::string path;
    unsigned offset = 0;
};

/// The same, but returns only where the line is.
located_line locate(const gpio_line_name& wanted);

/// Opens every chip, and no other file that has such a name.
std::vector<chip> read_chips();

/// Who holds a line now; empty: nobody, or it cannot be known.
std::string holder_of(const located_line& l);

} // namespace tactor::gpio
