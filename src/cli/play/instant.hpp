// SPDX-License-Identifier: MIT
/// \file
/// What a piece does at one time.
#pragma once

#include <optional>
#include <vector>

#include <tactor/tactor.hpp>

#include "cli/input.hpp"
#include "synth/score/sounding_now.hpp"

namespace tactor::cli {

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

} // namespace tactor::cli
