// SPDX-License-Identifier: MIT
/// \file
/// Complete pictures (strokes in several views, predicted percepts, bars and curves), and texts that describe
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
    double width_mm = 85.0; ///< the default is the width of a printed column
    bool heading = true;    ///< if true, name and facts are above the picture
    bool animated = false;  ///< SVG only: tactors light up while they play, in real time, in a loop
};

/// Greatest number of bursts in an animated picture.
inline constexpr std::size_t most_animated_bursts = 2000;

inline constexpr double least_width_mm = 60.0;
inline constexpr double most_width_mm = 1000.0;

/// Returns an empty picture. \throws error (bad_input) if the width is outside these bounds.
canvas make_canvas(double width_mm);

/// Returns a name for a scene. It is the name of the stroke if there is only one, otherwise the name of the
/// file.
std::string scene_name(const std::vector<stroke>& strokes, const std::string& file);

/// Draws a scene. Draws only the array if there are no strokes. The height depends on the content and is at
/// most 247 mm. If the picture is wider than 170 mm, this limit grows in proportion.
/// \throws error (bad_input) for more than most_animated_bursts, and as draw_wave_view() does.
canvas draw_figure(const scene& s, const figure_options& o);

/// Draws predicted percepts for several algorithms, as in figure 6 of Park et al. 2016. Each phantom model
/// has a row of panels, one for each algorithm, and a chart of speeds over time below it. The rows of `all`
/// must contain their samples. `title`, if not empty, is above the picture, together with the target's length
/// and time.
/// \throws error (bad_input) if the width is out of bounds.
canvas draw_comparison(const array& a, const detail::comparison& all, const std::string& title,
                       double width_mm);

struct bar {
    double height = 0.0;
    std::optional<std::pair<double, double>> error = {}; ///< lower and upper end of the error bar
    std::vector<double> values = {};                     ///< values whose mean is the height; a dot for each
};

/// Bars of the same colour, one in each group.
struct bar_series {
    std::string name = {}; ///< if empty, the series is not in the legend
    std::vector<bar> bars = {};
};

struct bar_panel {
    std::string title = {};
    std::string y_title = {};
    double y_from = 0.0;
    double y_to = 1.0;                ///< above y_from; cuts off bars, which start at the value nearest to 0
    std::optional<double> level = {}; ///< value of a dashed line, such as chance
    std::vector<std::string> groups = {};
    std::vector<bar_series> series = {}; ///< each has one bar for each group
    /// Number of leading groups whose values are joined within a series: a thin line joins the values of one
    /// series that have the same index in bar::values. In each of the other groups, lines join the values of
    /// all series.
    std::size_t joined = 0;
};

/// Counts in rows and columns, such as the answers to each stimulus.
struct matrix_panel {
    std::string title = {};
    std::string row_title = {};
    std::string column_title = {};
    std::vector<std::string> names = {};               ///< names of the rows and of the columns
    std::vector<std::vector<std::size_t>> counts = {}; ///< counts[row][column]
};

struct weighted_dot {
    spot at;               ///< in the units of the axes
    double weight = 1.0;   ///< the area of the dot grows with this
    std::string name = {}; ///< text next to the dot; may be empty
};

/// A function, and the values to which it has been fitted.
struct curve {
    std::string name = {};       ///< if empty, the curve is not in the legend
    std::size_t colour = 0;      ///< see stroke_colour()
    bool thick = false;          ///< true for a mean, which stands out among other lines
    std::vector<spot> line = {}; ///< in the units of the axes
    std::vector<weighted_dot> dots = {};
};

/// An axis of a panel of curves.
struct curve_axis {
    std::string title = {};
    double from = 0.0;
    double to = 1.0;                  ///< above `from`
    std::optional<double> level = {}; ///< value of a dashed line across the panel, such as chance
    bool logs = false;                ///< true if values are decimal logarithms
};

struct curve_panel {
    std::string title = {};
    curve_axis x = {};
    curve_axis y = {};
    std::vector<curve> curves = {}; ///< the first curve is drawn first, under the others
    std::string key = {};           ///< text next to the title, such as what the largest dot means
    bool to_scale = false;          ///< if true, scales are equal and y points down, as in arrays
};

struct panel_figure {
    std::string title = {};
    bool heading = true; ///< if true, the title is above the picture
    double width_mm = 170.0;
    std::string note = {};   ///< text below the picture
    std::string across = {}; ///< text across each panel, such as "simulated"
    std::vector<bar_panel> bars = {};
    std::vector<curve_panel> curves = {};    ///< drawn after the bars
    std::vector<matrix_panel> matrices = {}; ///< drawn after the curves
};

/// Draws the panels, in two columns if the width is at least 120 mm. In SVG, each panel is a group, and
/// programs can read its data:
/// * A panel of bars has kind "bars", data-title, data-y0 and data-y-scale: page = y0 + scale * value. A bar
/// has kind "bar", its error bar "error", a dot "value", a line between dots "value-line".
/// * A panel of curves has kind "curves", and also data-x0 and data-x-scale. A line has kind "curve" or
/// "mean-curve", a dot "dot", its name "name".
/// * A matrix has kind "matrix" and data-title. A cell has kind "cell"; it is darker if its share of the row
/// is larger.
/// * The visible title of a panel has kind "panel-title". It may be shorter than data-title.
canvas draw_panels(const panel_figure& f);

/// Returns a description of a plan's vibration for captions and listings: "250 Hz" (a sine), "square of 60 to
/// 120 Hz", "noise of 60 to 400 Hz", "brush.wav along the path". If the vibration is modulated, ", AM of 30
/// Hz" follows.
std::string describe_sound(const plan& p);

/// Returns the name of the phantom model. If its faces are not Delaunay faces, adds their name:
/// "inverse-distance (faces nearest)".
std::string describe_phantom(const plan& p);

inline constexpr std::size_t most_array_notes = 6; ///< number of lines

/// Draws the array, the path, the phantoms and their tactors at the top of a box, as in figure 3 of Park et
/// al. 2016. Returns the height of the drawing. If tactors would be too close for their numbers, the drawing
/// is higher than the box. Its height is at most `highest` pt plus most_array_notes lines.
double draw_array_view(canvas& c, const scene& s, const timeline& t, box at_most, double highest);

/// Draws the amplitude of each tactor over time in rows, as in figure 4 of Park et al. 2016. The drawing
/// begins at (where.x, where.y), goes down and is where.width wide. Returns its height. If `colours` is true,
/// a strip above the rows shows the colour of each time.
double draw_timing_view(canvas& c, const scene& s, const timeline& t, box where, bool colours);

/// Renders scene::sound, and draws the range of the samples of each channel that is not silent. If there is
/// space for the cycles, this shows the carrier, otherwise the envelope. The drawing begins at (where.x,
/// where.y), goes down and is where.width wide. Returns its height.
/// \throws error (bad_input) for too many samples.
double draw_wave_view(canvas& c, const scene& s, const timeline& t, box where);

} // namespace tactor::plot
