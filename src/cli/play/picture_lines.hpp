// SPDX-License-Identifier: MIT
/// \file
/// A piece at one time, and the array in characters, as large as a terminal allows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/input.hpp"
#include "synth/score/sounding_now.hpp"

namespace tactor::cli {

/// State of a piece at one time.
struct instant {
    std::vector<double> levels;  ///< per tactor, linear, 1 is the intensity asked for
    std::optional<point> target; ///< where the touch is
};

/// Follows a piece from its beginning on.
class piece_follower {
public:
    /// `p` must live as long.
    piece_follower(const piece& p, const score& s, const array& a);

    /// Times, in seconds from the start of the piece, are to ascend: what is over is not found again.
    instant at(double t_s);

private:
    const piece& piece_;
    score score_;
    layout faces_;
    synth::sounding_now sounding_;
};

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
