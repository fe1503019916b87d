// SPDX-License-Identifier: MIT
/// \file
/// Complete pictures: strokes with their views, predicted percepts, bars and curves; and texts that describe
/// a plan.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/plan.hpp>

#include "percept/compare.hpp"
#include "plot/draw/timeline.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

enum class figure_view { array, timing, wave, both };

struct figure_options {
    figure_view view = figure_view::both;
    double width_mm = 85.0; ///< default: one print column
    bool heading = true;    ///< true: name and facts above the picture
    bool animated = false;  ///< SVG: tactors light up while they play, again and again, in real time
};

/// Most bursts of an animated picture.
inline constexpr std::size_t most_animated_bursts = 2000;

inline constexpr double least_width_mm = 60.0;
inline constexpr double most_width_mm = 1000.0;

/// Returns an empty picture. \throws error (bad_input) for a width out of these bounds.
canvas make_canvas(double width_mm);

/// Returns the name of a scene: that of the only stroke, or of the file that holds several.
std::string name_scene(const std::vector<stroke>& strokes, const std::string& file);

/// Draws a scene; without strokes, its array alone. The height follows from the content; it is at most 247
/// mm, in proportion more for pictures wider than 170 mm. \throws error (bad_input): for the waveform, see
/// draw_wave_view(); for more than most_animated_bursts.
canvas draw_figure(const scene& s, const figure_options& o);

/// Draws predicted percepts of several algorithms (as figure 6 of Park et al. 2016): for each phantom model a
/// row of panels, one for each algorithm, and under it their speeds over time. Rows need their samples.
/// `title` is above the picture, with the target's length and time; empty: neither. \throws error (bad_input)
/// for a width out of bounds.
canvas draw_comparison(const array& a, const detail::comparison& all, const std::string& title,
                       double width_mm);

struct bar {
    double height = 0.0;
    std::optional<std::pair<double, double>> error = {}; ///< ends of the error bar
    std::vector<double> values = {};                     ///< values with the height as their mean: a dot each
};

/// Bars with the same look, one in each group.
struct bar_series {
    std::string name = {}; ///< empty: not in the legend
    std::vector<bar> bars = {};
};

struct bar_panel {
    std::string title = {};
    std::string y_title = {};
    double y_from = 0.0;
    double y_to = 1.0;                ///< above y_from; bars end here, and begin at the value closest to 0
    std::optional<double> level = {}; ///< a dashed line, such as chance
    std::vector<std::string> groups = {};
    std::vector<bar_series> series = {}; ///< each has as many bars as there are groups
    /// Number of groups at the beginning in which a thin line joins the values of one series that have the
    /// same place in bar::values. In each other group the line joins the values of all series.
    std::size_t joined = 0;
};

/// Counts by row and column, such as answers to stimuli.
struct matrix_panel {
    std::string title = {};
    std::string row_title = {};
    std::string column_title = {};
    std::vector<std::string> names = {};               ///< names of the rows, and of the columns
    std::vector<std::vector<std::size_t>> counts = {}; ///< by row, then column
};

struct weighted_dot {
    spot at;               ///< in units of the axes
    double weight = 1.0;   ///< the area grows with it
    std::string name = {}; ///< next to the dot; may be empty
};

/// A function, and the values to which it was fitted.
struct curve {
    std::string name = {};       ///< empty: not in the legend
    std::size_t colour = 0;      ///< see stroke_colour()
    bool thick = false;          ///< a mean; else a line among others
    std::vector<spot> line = {}; ///< in units of the axes
    std::vector<weighted_dot> dots = {};
};

/// An axis of curves.
struct curve_axis {
    std::string title = {};
    double from = 0.0;
    double to = 1.0;                  ///< above `from`
    std::optional<double> level = {}; ///< a dashed line across, such as chance
    bool logs = false;                ///< the values are decimal logarithms
};

struct curve_panel {
    std::string title = {};
    curve_axis x = {};
    curve_axis y = {};
    std::vector<curve> curves = {}; ///< drawn in order: the first one is lowest
    std::string key = {};           ///< next to the title, such as what the largest dot means
    bool to_scale = false;          ///< true: both axes have the same unit, and y points down, as in arrays
};

struct panel_figure {
    std::string title = {};
    bool heading = true; ///< true: the title is above the picture
    double width_mm = 170.0;
    std::string note = {};   ///< under the picture
    std::string across = {}; ///< text across each panel, such as "simulated"
    std::vector<bar_panel> bars = {};
    std::vector<curve_panel> curves = {};    ///< after the bars
    std::vector<matrix_panel> matrices = {}; ///< after the curves
};

/// Draws the panels, in two columns from 120 mm width on. Each panel of bars is an SVG group of kind "bars"
/// with data-title, data-y0 and data-y-scale: page = y0 + scale * value; each bar is of kind "bar", its error
/// bar of kind "error", a dot of kind "value", a line between dots of kind "value-line". One of curves is of
/// kind "curves", with data-x0 and data-x-scale, too: lines are of kind "curve" or "mean-curve", dots of kind
/// "dot", their names of kind "name". A matrix is a group of kind "matrix" with data-title: each cell, of
/// kind "cell", is the darker the larger its share of the row.
canvas draw_panels(const panel_figure& f);

/// Returns the vibration, for captions and listings: "250 Hz" (a sine), "square of 60 to 120 Hz", "noise of
/// 60 to 400 Hz", "brush.wav along the path"; with ", AM of 30 Hz" if it is modulated.
std::string describe_sound(const plan& p);

/// Returns the phantom model, and its faces if they are not Delaunay's: "inverse-distance (faces nearest)".
std::string describe_phantom(const plan& p);

inline constexpr std::size_t most_array_notes = 6; ///< lines

/// Draws the array, the path, the phantoms and their tactors (as figure 3 of Park et al. 2016) into the upper
/// part of a box. Returns the height taken. If tactors would be too close for their numbers, it is higher
/// than the box, but at most `highest` pt and most_array_notes lines.
double draw_array_view(canvas& c, const scene& s, const timeline& t, box at_most, double highest);

/// Draws the amplitude of each tactor over time, in rows (as figure 4 of Park et al. 2016). Draws from
/// (where.x, where.y) down, where.width wide; returns the height taken. With `colours` a strip above the rows
/// shows the colour of each time.
double draw_timing_view(canvas& c, const scene& s, const timeline& t, box where, bool colours);

/// Renders scene::sound and draws the range of the samples of each channel that is not silent, in columns: an
/// envelope, or the carrier if there is space for its cycles. From (where.x, where.y) down, where.width wide;
/// returns the height taken. \throws error (bad_input) for too many samples.
double draw_wave_view(canvas& c, const scene& s, const timeline& t, box where);

} // namespace tactor::plot
