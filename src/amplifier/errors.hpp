// SPDX-License-Identifier: MIT
/// \file
/// GPIO failures as advice.
#pragma once

#include <string>

#include <tactor/error.hpp>
#include <tactor/lines.hpp>

#include "amplifier/line.hpp"

namespace tactor::gpio {

/// The thing that failed: "setup.toml:3:1: GPIO line 17 of pinctrl-rp1".
std::string thing(const gpio_line_name& l);

/// Why it cannot be opened and what to do, for a list of chips.
std::string advice(const chip& c);

/// A chip that is there cannot be opened.
error open_error(const gpio_line_name& l, const chip& c);

/// The kernel refused the line. `holder`: the consumer it names for it.
error request_error(const gpio_line_name& l, int code, const std::string& holder);

} // namespace tactor::gpio
