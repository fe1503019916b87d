// SPDX-License-Identifier: MIT
/// \file
/// Which line of which chip a user means. Pure: the chips are values.
#pragma once

#include <cstddef>
#include <span>

#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace tactor::gpio {

/// A line that exists: chips[chip].info.lines[offset].
struct line_place {
    std::size_t chip = 0;
    unsigned offset = 0;
};

/// A chip is named by path or by label, a line by name or by offset; a name is looked for on the chip that is
/// given, or on all.
/// \throws error: not_available, with what there is instead; bad_input without a name and without chip and
///         offset.
line_place find_line(std::span<const chip> chips, const gpio_line_name& wanted);

} // namespace tactor::gpio
