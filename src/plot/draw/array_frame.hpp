// SPDX-License-Identifier: MIT
/// \file
/// The array on the page, to scale, and places of labels next to it.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Chooser of places for labels and arrows: they lie on nothing that is blocked, and where they cover the
/// least of what they should avoid.
class label_placer {
public:
    /// Starts with no place taken. Labels stay inside `area`.
    explicit label_placer(box area) : area_(area) {}

    void block(box b) { blocked_.push_back(b); }
    void block_disc(spot centre, double radius);
    void avoid_disc(spot centre, double radius);
    void avoid_line(const std::vector<spot>& line);

    /// Returns how many square points of what to avoid a box covers; nothing if it leaves the area or covers
    /// something blocked.
    std::optional<double> cover(box b) const;

    /// Returns the start of the baseline of `text` in one of eight directions from one of many sites, from
    /// `gap` up to `reach` pt farther away, and blocks that place. Returns nothing if each place is off the
    /// area, blocked, or not clearly nearer to that site than to the others.
    std::optional<spot> place(std::string_view text, double size, const std::vector<spot>& sites,
                              std::size_t own, double gap, double reach);

private:
    box area_;
    std::vector<box> blocked_;
    std::vector<box> avoided_;
};

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
    double scale = 1.0;  ///< pt for each mm
    spot origin = {};    ///< place of 0, 0 mm
    box area = {};       ///< area of the array, margins included
    double pitch = 0.0;  ///< distance of neighbours, pt
    double radius = 5.0; ///< radius of a tactor's circle, pt
    double number = 7.0; ///< size of the numbers in the circles, pt; 0: there is no space

    spot operator()(point p) const noexcept { return {origin.x + scale * p.x_mm, origin.y + scale * p.y_mm}; }
};

/// Returns the extent of the array and of the strokes near it.
extent shown_extent(const array& a, const std::vector<stroke>& strokes);

/// Fits the extent into the upper middle of a box, as large as possible. `space`: room for labels around it,
/// pt.
array_frame fit_array(const array& a, const extent& shown, box at_most, spot space = {17.0, 14.0});

/// Returns the path on the page, in parts inside the frame's area. The number of points is bounded.
std::vector<std::vector<spot>> path_on_page(const array_frame& f, const trajectory& motion);

/// Returns true if each tactor is on the channel of the same number, so that one number is enough.
bool channels_are_numbers(const array& a);

/// Draws a bar of a round number of mm with its label, left end at `at`.
void draw_scale_bar(canvas& c, const array_frame& f, spot at);

} // namespace tactor::plot
