// SPDX-License-Identifier: MIT
/// \file
/// The GPIO chips of this machine, the search for the line that a user named, and messages about both.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace tactor::amplifier {

/// An existing line: chips[chip].info.lines[offset].
struct line_place {
    std::size_t chip = 0;
    unsigned offset = 0;
};

/// Finds the line that a user named. Pure: it only looks at the given chips. A path or a label names the
/// chip; a name or an offset names the line. Without a chip, searches the name on all chips.
/// \throws error: not_available with a list of the existing chips or lines; bad_input if there is neither a
///         name nor chip and offset.
line_place find_line(std::span<const chip> chips, const gpio_line_name& wanted);

/// Returns the device nodes gpiochipN in a folder, by number. Skips links: Raspberry Pi kernels keep
/// gpiochip4 as a second name of gpiochip0.
std::vector<std::string> chip_paths(const std::filesystem::path& folder = "/dev");

/// Returns an errno that says why a path is not a GPIO chip; 0 if it is one. Opens nothing, because opening a
/// pipe blocks and opening a watchdog starts it.
int find_chip_fault(const std::string& path);

/// Returns the name of the group that owns a file, or "gpio" if it is not known.
std::string find_group(const std::string& path);

/// Finds a line among the chips of this machine. Throws as find_line() does.
gpio_line_place look_up(const gpio_line_name& wanted);

/// Returns the consumer that holds a line now; empty if there is none or it is not known.
std::string find_holder(const gpio_line_place& l);

/// Returns the name of a line for messages: "setup.toml:3:1: GPIO line 17 of pinctrl-rp1".
std::string describe_line(const gpio_line_name& l);

/// Returns why a chip cannot be opened and what to do, for a list of chips.
std::string advice(const chip& c);

/// Returns the error of a line that the kernel refused. `holder`: the consumer that the kernel names.
error request_error(const gpio_line_name& l, int code, const std::string& holder);

} // namespace tactor::amplifier
