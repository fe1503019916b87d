// SPDX-License-Identifier: MIT
/// \file
/// Axes, line charts, lines that are clipped or have fewer points, headings over a picture, notes under it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Linear map from values to the page.
struct scale {
    double from = 0.0; ///< value at page_from
    double to = 1.0;   ///< value at page_to; not equal to `from`
    double page_from = 0.0;
    double page_to = 1.0;

    double per_unit() const noexcept { return (page_to - page_from) / (to - from); }
    double operator()(double v) const noexcept { return page_from + (v - from) * per_unit(); }
};

/// Round numbers, at a distance of 1, 2 or 5 times a power of ten.
struct ticks {
    double step = 1.0;
    std::vector<double> at = {};
    bool logs = false; ///< values are decimal logarithms; labels show the numbers themselves

    /// Returns the label of a value, with as many decimals as the step needs.
    std::string label(double v) const;
};
/// Returns at most `most` ticks in lo ... hi, and at least one if lo <= 0 <= hi.
ticks nice_ticks(double lo, double hi, std::size_t most);
/// Returns ticks at round numbers whose decimal logarithms are in lo ... hi. Below a decade there are at most
/// `most` ticks. Over a decade or more, ticks are at 1, 2 and 5 times powers of ten. If these are more than
/// `most`, ticks are at powers of ten alone, however many.
ticks log_ticks(double lo, double hi, std::size_t most);

inline constexpr double small_text = 6.0; ///< pt, smallest in a picture as wide as one print column
inline constexpr double label_text = 6.5;
inline constexpr double title_text = 7.0;

/// Height that draw_horizontal_axis() needs under the line, pt.
inline constexpr double axis_height = 19.0;

/// Gap between a diagram's lowest row and that line, pt.
inline constexpr double axis_gap = 1.5;

/// Draws a line at y, ticks and labels under it, `title` under these, and light lines from `grid_top` down to
/// the line. `logs`: the values are decimal logarithms.
void draw_horizontal_axis(canvas& c, const scale& x, double y, double grid_top, const std::string& title,
                          bool logs = false);

/// Draws a line at the left of `inside` with ticks and labels, light lines across, and `title` upwards with
/// its foot at title_x.
void draw_vertical_axis(canvas& c, const scale& y, const ticks& t, box inside, const std::string& title,
                        double title_x);

/// A line of a chart over time; a value that is not finite interrupts it.
struct series {
    std::string name = {};
    std::vector<spot> values = {}; ///< in units of the axes
    style look = {.stroke = ink, .width = 0.8};
};

/// Draws samples of lines and their names, in rows up to `width`, from (x, y) down. Returns the height, also
/// without a canvas.
double draw_line_legend(canvas* c, const std::vector<series>& lines, double x, double y, double width);

/// Area between two lines of a chart.
struct chart_band {
    std::string name = {};
    std::vector<spot> low = {}; ///< in units of the axes, by x
    std::vector<spot> high = {};
    style look = {};
};

struct chart {
    std::string id = {};
    box where = {};    ///< area of the whole chart, with labels and legend
    double x_to = 1.0; ///< from 0, s
    double y_to = 1.0; ///< from 0
    std::string y_title = {};
    std::vector<series> lines = {};
    std::vector<chart_band> bands = {}; ///< behind the lines, within the axes
};

/// Draws the chart with its legend above, and clips lines to the axes. The number of points on the page is
/// bounded by the width. Returns the box inside the axes. Its SVG group has data-x0,
/// data-x-scale, data-y0 and data-y-scale: page = 0 + scale * value.
box draw_chart(canvas& c, const chart& ch);

/// Returns the parts of a line inside a box.
std::vector<std::vector<spot>> clip(const std::vector<spot>& line, box b);

/// Returns a line with fewer points, nowhere more than `tolerance` pt away (Douglas and Peucker).
std::vector<spot> simplify(const std::vector<spot>& line, double tolerance);

/// Returns the distance of a point from the segment between two others, pt.
double distance(spot p, spot a, spot b) noexcept;

inline constexpr double note_height = 8.0; ///< height of a line, pt

/// Returns the parts that are not empty, with a separator between them.
std::string join(const std::vector<std::string>& parts, std::string_view separator);

/// Draws a text in at most `most_lines` small lines, from the upper edge of a box down. Returns the height
/// that it took.
double draw_words(canvas& c, std::string_view text, box where, std::size_t most_lines, const char* kind);

/// Draws the notes that are not empty in the same way.
double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines);

/// Draws a title and a text under it, from the upper edge of a box down. Returns the height that it took.
double draw_heading(canvas& c, const std::string& title, std::string_view text, box where);

} // namespace tactor::plot
