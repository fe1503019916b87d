// SPDX-License-Identifier: MIT
/// \file
/// The array in characters, as large as a terminal allows.
#pragma once

#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/play/instant.hpp"

namespace tactor::cli {

struct terminal_size {
    unsigned columns = 80;
    unsigned rows = 24;

    friend bool operator==(const terminal_size&, const terminal_size&) = default;
};

struct picture_style {
    bool unicode = true; ///< shades, not letters
    bool colours = true;
};

/// The array with each tactor's level and the place of the touch, and under it time, place and progress: at
/// most rows - 1 lines of columns - 1 characters, so that nothing wraps or scrolls. Where there is less space
/// the array is drawn smaller, then left out, and then what the last line says.
std::vector<std::string> picture_lines(const array& a, const instant& now, double t_s, double total_s,
                                       terminal_size size, picture_style style);

} // namespace tactor::cli
