// SPDX-License-Identifier: MIT
/// \file
/// The GPIO lines of [amplifier] and [sync].
#pragma once

#include <functional>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/check/finding.hpp"

namespace tactor::cli {

/// Finds a line, or throws what find_gpio_line() throws.
using line_finder = std::function<gpio_line_place(const gpio_line_name&)>;

/// Whether each line is there and free, and where the array is `felt`, whether there is one for its
/// amplifier. None is requested or driven.
std::vector<finding> check_lines(const setup& config, bool felt, const line_finder& find);

} // namespace tactor::cli
