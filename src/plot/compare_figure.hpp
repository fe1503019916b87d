// SPDX-License-Identifier: MIT
/// \file
/// Predicted percepts of several algorithms (as figure 6 of Park et al. 2016), and their speeds.
#pragma once

#include <string>

#include <tactor/array.hpp>

#include "percept/compare.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Draws for each phantom model a row of panels, one for each algorithm, and under it their speeds over time.
/// Rows need their samples. `title` is above the picture, with the target's length and time; empty: neither.
/// \throws error (bad_input) for a width out of bounds (figure.hpp).
canvas draw_comparison(const array& a, const detail::comparison& all, const std::string& title,
                       double width_mm);

} // namespace tactor::plot
