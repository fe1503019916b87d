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

/// Where the millimetres of the skin are on the page: the same scale along x and y.
struct array_frame {
    double scale = 1.0;  ///< pt to the mm
    spot origin = {};    ///< of 0, 0 mm
    box area = {};       ///< that the array takes, margins included
    double pitch = 0.0;  ///< of neighbours, pt
    double radius = 5.0; ///< of a tactor's circle, pt
    double number = 7.0; ///< size of the numbers in the circles, pt; 0: they have no space

    spot operator()(point p) const noexcept { return {origin.x + scale * p.x_mm, origin.y + scale * p.y_mm}; }
};

/// The array and the movement of strokes over it, as far as these are near it.
extent shown_extent(const array& a, const std::vector<stroke>& strokes);

/// Room round what is shown, for labels, pt.
struct surround {
    double x = 17.0;
    double y = 14.0;
};

/// Puts what is shown into the upper middle of a box, as large as it goes.
array_frame fit_array(const array& a, const extent& shown, box at_most, surround space = {});

/// The movement on the page: bounded in points, inside the frame's area.
std::vector<std::vector<spot>> path_on_page(const array_frame& f, const trajectory& motion);

/// Whether each tactor is on the channel of its own number: then one of the two says both.
bool channels_are_numbers(const array& a);

/// What is drawn of tactors, by index.
struct tactor_looks {
    std::vector<bool> plays = {};  ///< else lighter
    std::vector<bool> inside = {}; ///< its number stands in its circle; else something lies on that
};

/// Circles, with the numbers that stand in them. Their places are forbidden to labels.
void draw_tactors(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                  label_placer& taken);

/// Numbers that do not stand in their circles, and channels that are other numbers, each beside its own
/// tactor and on nothing else. Returns what had no space, in words; empty: all has.
std::string draw_tactor_labels(canvas& c, const array_frame& f, const array& a, const tactor_looks& looks,
                               label_placer& taken);

/// A bar of a round number of mm with its label, left end at `at`.
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

/// Writes start and end beside those marks; of several strokes, the number of each at its start. Returns what
/// had no space, in words; empty: all has.
std::string label_strokes(canvas& c, const scene& s, const timeline& t, const array_frame& f, double dot,
                          label_placer& taken);

} // namespace tactor::plot
