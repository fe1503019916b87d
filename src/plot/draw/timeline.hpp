// SPDX-License-Identifier: MIT
/// \file
/// Contents of a picture over a common time. A scene consists of an array, strokes and their plans. A diagram
/// has a row for each tactor that plays; if there are very many tactors, several share a row. Above the rows
/// are the starts of strokes. There is also a legend of strokes.
#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>
#include <tactor/stroke.hpp>

#include "plot/draw/axes.hpp"
#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Contents of a picture. The referenced objects must outlive it.
struct scene {
    const array& tactors;
    std::string name;                      ///< name of the scene
    const std::vector<stroke>& strokes;    ///< if empty, only the array is drawn
    const std::vector<placed_plan>& plans; ///< one for each stroke
    const score* sound = nullptr;          ///< score whose waveform is drawn
    /// Predicted places of bursts that were moved for an observer. Empty, or one element for each stroke.
    std::span<const compensated_plan> moved = {};
};

/// A burst at its time in the scene. For the algorithm `continuous`, it is an instant.
struct shown_burst {
    std::size_t number = 0; ///< number in the scene, from 0
    std::size_t stroke = 0;
    double from_s = 0.0;
    double to_s = 0.0;
    double target_s = 0.0; ///< time at which the target reaches the burst's position
    const burst* what = nullptr;
};

/// The bursts of a scene on a common time axis. The plans of the scene must outlive it.
struct timeline {
    std::vector<double> starts_s = {};   ///< start of each stroke
    std::vector<double> ends_s = {};     ///< end of each stroke, including its last burst
    std::vector<std::size_t> looks = {}; ///< colour index of each stroke, from 0; repeats have the same
    double total_s = 0.0;
    std::vector<shown_burst> bursts = {};
    std::vector<unsigned> playing = {}; ///< tactors that play, in ascending order
    double peak = 1.0;                  ///< greatest amplitude, but at least 1
    bool sampled = false;               ///< true if a plan is continuous: `bursts` then has instants
    double sample_s = 0.0;              ///< time between two instants
    std::deque<burst> instants = {};    ///< bursts that stand for the instants

    /// Returns true if there are several strokes. In this case, colours stand for strokes instead of times.
    bool has_several_strokes() const noexcept { return starts_s.size() > 1; }

    timeline() = default;
    timeline(timeline&&) = default;
    timeline& operator=(timeline&&) = default;
};

timeline make_timeline(const scene& s);

/// Draws a strip with the colours of time along x. In an animated picture, a mark moves along the strip.
void draw_time_strip(canvas& c, box where);

/// Returns the colour of a burst. If there is only one stroke, it depends on the burst's time, otherwise on
/// the stroke.
colour burst_colour(const timeline& t, const shown_burst& b) noexcept;

struct lane {
    std::vector<unsigned> tactors = {};
    std::string label = {}; ///< "4", or "4 (7)" if the channel differs, or "100-103"
};

inline constexpr double highest_level = 11.0; ///< pt

struct lanes {
    std::vector<lane> rows = {};
    std::vector<int> row_by_tactor = {}; ///< -1 for tactors that do not play
    std::size_t levels = 1;              ///< levels in each row, for simultaneous strokes
    double height = 0.0;                 ///< height of a level, pt
    std::string heading = {};            ///< text above the labels
    double label_width = 0.0;            ///< pt

    double row_height() const noexcept { return height * static_cast<double>(levels); }
    /// Returns the distance from the top of the first row to the top of `row`, pt. If `row` is the number of
    /// rows, returns the height of all rows.
    double top(std::size_t row) const noexcept { return row_height() * static_cast<double>(row); }
    double total_height() const noexcept { return top(rows.size()); }

    /// Makes levels as high as possible in `space` pt, but at most `highest` pt. Returns false if there is
    /// not enough space even for the lowest levels.
    bool fit(double space, double highest = highest_level);
};

/// Makes a row for each playing tactor, or for several. The rows have no height before fit(). `space` is the
/// height for all rows, pt.
lanes make_lanes(const array& a, const std::vector<unsigned>& playing, double space);

/// Draws the labels of the rows. They end at x, and the first row begins at `top`. If there is not enough
/// space for all labels, draws every n-th label and returns a note about this; otherwise returns "".
std::string draw_lane_labels(canvas& c, const lanes& l, double x, double top);

/// Range of the values in one column of the page.
struct column_range {
    float low = 0.0F;
    float high = 0.0F;
};

/// Returns closed outlines of the columns. Each outline goes around adjacent columns that are not 0. The
/// edges of the columns are at x(0), x(1), ...
std::vector<std::vector<spot>> outline(const std::vector<column_range>& columns, const scale& x,
                                       const scale& y);

inline constexpr double column_width = 0.4; ///< pt

/// Height above the diagram that draw_stroke_starts() needs, pt. It is 0 for a single stroke.
double starts_height(const timeline& t);

/// Draws a vertical line at the start of each stroke if there are several strokes. The line runs from above
/// the diagram to its bottom. At its top are the numbers of all strokes that begin there. Returns a note
/// about starts for which there is no space, or "".
std::string draw_stroke_starts(canvas& c, const timeline& t, const scale& x, double top, double bottom);

/// Draws the legend of strokes if there are several: number, colour and name of each stroke, in columns, at
/// the top of a box. Repeats of a stroke share an entry. Returns the height, which is 0 for a single stroke.
/// `colours` is true if strokes have different colours in the picture.
double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
