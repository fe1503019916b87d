// SPDX-License-Identifier: MIT
/// \file
/// Which way a stroke runs: arrows, start and end.
#pragma once

#include <string>

#include "plot/draw/array_frame.hpp"
#include "plot/draw/timeline.hpp"

namespace tactor::plot {

/// Arrowheads on the path where they cover least, a ring at the start and a square at the end. `dot`: radius
/// of the bursts' dots, pt.
void draw_path_marks(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
                     label_placer& taken);

/// Of the ring at a start, and half a side of the square at an end, pt.
constexpr double end_mark_radius(double dot) noexcept
{
    return dot + 1.7;
}

/// The words start and end beside those; of several strokes, the number of each at its start. Returns what
/// had no space, in words; empty: all has.
std::string label_strokes(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
                          label_placer& taken);

} // namespace tactor::plot
