// SPDX-License-Identifier: MIT
/// \file
/// The array on the page, to scale.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "plot/draw/label_placer.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// A rectangle on the skin, mm.
struct extent {
    double x0 = 0.0;
    double y0 = 0.0;
    double x1 = 0.0;
    double y1 = 0.0;

    void add(point p) noexcept;
};

/// Map from the skin, mm, to the page, with the same scale along x and y.
struct array_frame {
    double scale = 1.0;  ///< pt to the mm
    spot origin = {};    ///< place of 0, 0 mm
    box area = {};       ///< of the array, margins included
    double pitch = 0.0;  ///< distance of neighbours, pt
    double radius = 5.0; ///< of a tactor's circle, pt
    double number = 7.0; ///< size of the numbers in the circles, pt; 0: there is no space

    spot operator()(point p) const noexcept { return {origin.x + scale * p.x_mm, origin.y + scale * p.y_mm}; }
};

/// Returns the extent of the array and of the strokes near it.
extent shown_extent(const array& a, const std::vector<stroke>& strokes);

/// Space for labels around the extent, pt.
struct surround {
    double x = 17.0;
    double y = 14.0;
};

/// Fits the extent into the upper middle of a box, as large as possible.
array_frame fit_array(const array& a, const extent& shown, box at_most, surround space = {});

/// Returns the path on the page, in parts inside the frame's area. The number of points is bounded.
std::vector<std::vector<spot>> path_on_page(const array_frame& f, const trajectory& motion);

/// Returns true if each tactor is on the channel of the same number, so that one number is enough.
bool channels_are_numbers(const array& a);

/// Looks of tactors, by index.
struct tactor_looks {
    std::vector<bool> plays = {};  ///< false: lighter
    std::vector<bool> inside = {}; ///< true: its number is in its circle
};

/// Draws circles, with the numbers that are inside, and keeps labels away from them.
void draw_tactors(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                  label_placer& taken);

/// Draws numbers that are not in their circles, and channels that differ from numbers, each next to its
/// tactor and on nothing else. Returns a note on labels without space; empty: all have space.
std::string draw_tactor_labels(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                               label_placer& taken);

/// Draws a bar of a round number of mm with its label, left end at `at`.
void draw_scale_bar(canvas& c, const array_frame& f, spot at);

/// Draws arrowheads on the path where they cover least, a ring at the start and a square at the end. `dot`:
/// radius of the bursts' dots, pt.
void draw_path_marks(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
                     label_placer& taken);

/// Returns the radius of the ring at a start, and half a side of the square at an end, pt.
constexpr double end_mark_radius(double dot) noexcept
{
    return dot + 1.7;
}

/// Writes start and end next to those marks; for several strokes, the number of each at its start. Returns a
/// note on labels without space; empty: all have space.
std::string label_strokes(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
                          label_placer& taken);

} // namespace tactor::plot
