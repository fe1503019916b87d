// SPDX-License-Identifier: MIT
/// \file
/// The array on the page, to scale, and the placing of labels next to it.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Finder of places for labels and arrows. A place never covers anything that is blocked, and covers as
/// little as possible of the things to avoid.
class label_placer {
public:
    /// Constructs a finder without blocked places. Labels stay inside `area`.
    explicit label_placer(box area) : area_(area) {}

    void block(box b) { blocked_.push_back(b); }
    void block_disc(spot centre, double radius);
    void avoid_disc(spot centre, double radius);
    void avoid_line(const std::vector<spot>& line);

    /// Returns the area of things to avoid that a box would cover, in square points. Returns nothing if the
    /// box is partly outside the area, or would cover something that is blocked.
    std::optional<double> cover(box b) const;

    /// Finds a place for `text` next to the site `own` of `sites`. Tries eight directions, and distances from
    /// `gap` to `gap` + `reach` pt. Returns the start of the text's baseline and blocks the place. Returns
    /// nothing if each place is outside the area, blocked, or not clearly nearer to the own site than to the
    /// other sites.
    std::optional<spot> place(std::string_view text, double size, const std::vector<spot>& sites,
                              std::size_t own, double gap, double reach);

private:
    box area_;
    std::vector<box> blocked_;
    std::vector<box> avoided_;
};

/// A rectangle on the skin, in mm.
struct extent {
    double x0 = 0.0;
    double y0 = 0.0;
    double x1 = 0.0;
    double y1 = 0.0;

    void add(point p) noexcept;
};

/// Mapping from the skin, in mm, to the page. The scale is the same for x and y.
struct array_frame {
    double scale = 1.0;  ///< pt per mm
    spot origin = {};    ///< the point (0, 0) mm on the page
    box area = {};       ///< area of the array, including margins
    double pitch = 0.0;  ///< distance between neighbouring tactors, pt
    double radius = 5.0; ///< radius of a tactor's circle, pt
    double number = 7.0; ///< size of the numbers in circles, pt; 0 if there is no space

    spot operator()(point p) const noexcept { return {origin.x + scale * p.x_mm, origin.y + scale * p.y_mm}; }
};

/// Returns the extent of the array and of those parts of strokes that are near the array.
extent shown_extent(const array& a, const std::vector<stroke>& strokes);

/// Fits an extent into a box, as large as possible, at the top and centred horizontally. `space` is the space
/// for labels around the extent, pt.
array_frame fit_array(const array& a, const extent& shown, box at_most, spot space = {17.0, 14.0});

/// Returns the parts of a path that are inside the frame's area, in coordinates of the page. The number of
/// points is limited.
std::vector<std::vector<spot>> map_path_to_page(const array_frame& f, const trajectory& motion);

/// Returns true if each tactor's channel has the same number as the tactor. Pictures then need only one
/// number.
bool has_matching_channels(const array& a);

/// Draws a scale bar and its label. The bar's length is a round number of mm, and its left end is at `at`.
void draw_scale_bar(canvas& c, const array_frame& f, spot at);

} // namespace tactor::plot
