// SPDX-License-Identifier: MIT
/// \file
/// The terminal that standard output is, where it is one.
#pragma once

#include <string>

#include "cli/play/picture_lines.hpp"

namespace tactor::cli {

/// Returns true if standard output is a terminal on which lines can be drawn again.
bool can_draw();

/// Returns true unless NO_COLOR asks for no colours (no-color.org: set, and not empty).
bool may_colour();

/// Whether the locale's characters are UTF-8.
bool speaks_utf8();

/// Writes to the terminal without ever waiting for it: one that was stopped (Ctrl-S), or is slow, must not
/// keep a signal from ending the program.
class terminal {
public:
    terminal();
    ~terminal();
    terminal(const terminal&) = delete;
    terminal& operator=(const terminal&) = delete;

    /// As it is now; people resize windows.
    terminal_size size() const noexcept;

    /// Whether all that was given to write() has been taken.
    bool idle();
    void write(std::string text);
    /// Waits a little for what is left.
    void finish();

private:
    int fd_;
    std::string left_;
};

} // namespace tactor::cli
