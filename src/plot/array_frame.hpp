// SPDX-License-Identifier: MIT
/// \file
/// The array on the page, to scale.
#pragma once

#include <vector>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "plot/canvas.hpp"
#include "plot/label_placer.hpp"

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

    spot operator()(point p) const noexcept { return {origin.x + scale * p.x_mm, origin.y + scale * p.y_mm}; }
};

/// The array and the movement of strokes over it, as far as these are near it.
extent shown_extent(const array& a, const std::vector<stroke>& strokes);

/// Puts what is shown into the upper middle of a box, as large as it goes.
array_frame fit_array(const array& a, const extent& shown, box at_most);

/// The movement on the page: bounded in points, inside the frame's area.
std::vector<std::vector<spot>> path_on_page(const array_frame& f, const trajectory& motion);

/// How tactors are told apart.
enum class numbering { inside, beside };

/// Circles, with numbers inside if so asked and there is room; lighter where `plays` (by index) is false.
/// Blocks their places.
void draw_tactors(canvas& c, const array_frame& f, const array& a, const std::vector<bool>& plays,
                  numbering where, label_placer& taken);

/// Channels, and numbers where they are not inside, beside the tactors; with little room only the numbers of
/// those that play.
void draw_tactor_labels(canvas& c, const array_frame& f, const array& a, const std::vector<bool>& plays,
                        numbering where, label_placer& taken);

/// A bar of a round number of mm with its label, left end at `at`.
void draw_scale_bar(canvas& c, const array_frame& f, spot at);

} // namespace tactor::plot
