// SPDX-License-Identifier: MIT
/// \file
/// Axes, line charts, clipping and thinning of lines, headings above a picture and notes below it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Linear mapping from values to the page.
struct scale {
    double from = 0.0; ///< value at page_from
    double to = 1.0;   ///< value at page_to; must differ from `from`
    double page_from = 0.0;
    double page_to = 1.0;

    double points_per_unit() const noexcept { return (page_to - page_from) / (to - from); }
    double operator()(double v) const noexcept { return page_from + (v - from) * points_per_unit(); }
};

/// Round numbers. The distance between them is 1, 2 or 5 times a power of ten.
struct ticks {
    double step = 1.0;
    std::vector<double> at = {};
    bool logs = false; ///< true if values are decimal logarithms; labels show the numbers

    /// Returns the label of a value. It has as many decimals as the step requires.
    std::string label(double v) const;
};
/// Returns at most `most` ticks from lo to hi. There is at least one tick if lo <= 0 <= hi.
ticks nice_ticks(double lo, double hi, std::size_t most);
/// Returns ticks at round numbers whose decimal logarithms are from lo to hi. If the range is less than a
/// decade, there are at most `most` ticks. Otherwise ticks are at 1, 2 and 5 times powers of ten. If these
/// are more than `most`, ticks are only at powers of ten, even if these are also more.
ticks log_ticks(double lo, double hi, std::size_t most);

inline constexpr double small_text = 6.0; ///< pt; smallest text in a picture of one column's width
inline constexpr double label_text = 6.5;
inline constexpr double title_text = 7.0;

/// Height below the line that draw_horizontal_axis() needs, pt.
inline constexpr double axis_height = 19.0;

/// Gap between the lowest row of a diagram and the line of its axis, pt.
inline constexpr double axis_gap = 1.5;

/// Draws a horizontal axis at y: the line, ticks and labels below it, and `title` below the labels. Light
/// vertical lines run from `grid_top` to the axis. `logs` is true if values are decimal logarithms.
void draw_horizontal_axis(canvas& c, const scale& x, double y, double grid_top, const std::string& title,
                          bool logs = false);

/// Draws a vertical axis at the left of `inside` with ticks and labels. Light horizontal lines cross
/// `inside`. The title is written upwards; its baseline is at title_x.
void draw_vertical_axis(canvas& c, const scale& y, const ticks& t, box inside, const std::string& title,
                        double title_x);

/// A line of a chart over time. Values that are not finite leave gaps in it.
struct series {
    std::string name = {};
    std::vector<spot> values = {}; ///< in the units of the axes
    style look = {.stroke = ink, .width = 0.8};
};

/// Draws the legend of lines from (x, y) down, in rows of at most `width`. An entry has a sample of the line
/// and its name. Returns the height. If `c` is null, only computes the height.
double draw_line_legend(canvas* c, const std::vector<series>& lines, double x, double y, double width);

/// The area between two lines of a chart.
struct chart_band {
    std::string name = {};
    std::vector<spot> low = {}; ///< in the units of the axes, x ascending
    std::vector<spot> high = {};
    style look = {};
};

struct chart {
    std::string id = {};
    box where = {};    ///< area of the chart, including labels and legend
    double x_to = 1.0; ///< end of the time axis, s; it starts at 0
    double y_to = 1.0; ///< end of the value axis; it starts at 0
    std::string y_title = {};
    std::vector<series> lines = {};
    std::vector<chart_band> bands = {}; ///< drawn behind the lines and inside the axes
};

/// Draws a chart with its legend above. Lines are clipped to the axes. The number of points on the page is
/// limited in proportion to the width. Returns the box inside the axes. The group in SVG has data-x0,
/// data-x-scale, data-y0 and data-y-scale: x on the page = x0 + x-scale * value, and the same for y.
box draw_chart(canvas& c, const chart& ch);

/// Returns the parts of a line that are inside a box.
std::vector<std::vector<spot>> clip(const std::vector<spot>& line, box b);

/// Returns a line with fewer points that is at most `tolerance` pt away from the original (Douglas and
/// Peucker).
std::vector<spot> simplify(const std::vector<spot>& line, double tolerance);

/// Returns the distance of a point p from the segment between a and b, pt.
double distance(spot p, spot a, spot b) noexcept;

inline constexpr double note_height = 8.0; ///< height of a line, pt

/// Returns the non-empty parts, separated by `separator`.
std::string join(const std::vector<std::string>& parts, std::string_view separator);

/// Draws a text in the size small_text at the top of a box, in at most `most_lines` lines. Returns the height
/// of the lines.
double draw_wrapped_text(canvas& c, std::string_view text, box where, std::size_t most_lines,
                         const char* kind);

/// Draws those notes that are not empty, in the same way as draw_wrapped_text().
double draw_notes(canvas& c, const std::vector<std::string>& notes, box where, std::size_t most_lines);

/// Draws a title, and a text below it, at the top of a box. Returns the height of both.
double draw_heading(canvas& c, const std::string& title, std::string_view text, box where);

} // namespace tactor::plot
