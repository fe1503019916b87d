// SPDX-License-Identifier: MIT
/// \file
/// Explanations and hints for GPIO failures.
#pragma once

#include <string>

#include <tactor/error.hpp>
#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace tactor::amplifier {

/// Returns the name of the line that failed: "setup.toml:3:1: GPIO line 17 of pinctrl-rp1".
std::string thing(const gpio_line_name& l);

/// Returns why a chip cannot be opened and what to do, for a list of chips.
std::string advice(const chip& c);

/// Returns the error of an existing chip that cannot be opened.
error open_error(const gpio_line_name& l, const chip& c);

/// Returns the error of a line that the kernel refused. `holder`: the consumer that the kernel names.
error request_error(const gpio_line_name& l, int code, const std::string& holder);

} // namespace tactor::amplifier
