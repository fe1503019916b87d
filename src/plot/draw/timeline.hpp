// SPDX-License-Identifier: MIT
/// \file
/// Contents of a picture with a common time: an array, strokes and their plans; rows of diagrams over this
/// time, one for each tactor that plays (or for several tactors, if there are very many); the starts of
/// strokes above the rows, and the legend of strokes.
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

/// Contents of a picture. Its parts must live as long.
struct scene {
    const array& tactors;
    std::string name;                      ///< name of the whole scene
    const std::vector<stroke>& strokes;    ///< none: only the array is drawn
    const std::vector<placed_plan>& plans; ///< one for each stroke
    const score* sound = nullptr;          ///< for the waveform
    /// Felt places of bursts that were moved for an observer; none, or one for each stroke.
    std::span<const compensated_plan> moved = {};
};

/// A burst in the time of the scene; for `continuous`, an instant.
struct shown_burst {
    std::size_t number = 0; ///< its number in the scene, from 0
    std::size_t stroke = 0;
    double from_s = 0.0;
    double to_s = 0.0;
    double target_s = 0.0; ///< time at which the target is at the burst's position
    const burst* what = nullptr;
};

/// Bursts of a scene, in a common time. The scene's plans must live as long.
struct timeline {
    std::vector<double> starts_s = {};   ///< start of each stroke
    std::vector<double> ends_s = {};     ///< end of each stroke, its last burst included
    std::vector<std::size_t> looks = {}; ///< look of each stroke, from 0; repeats share a look
    double total_s = 0.0;
    std::vector<shown_burst> bursts = {};
    std::vector<unsigned> playing = {}; ///< tactors that play, ascending
    double peak = 1.0;                  ///< largest amplitude, at least 1
    bool sampled = false;               ///< a plan is continuous: its "bursts" are instants
    double sample_s = 0.0;              ///< interval of the instants
    std::deque<burst> instants = {};    ///< the bursts of these instants

    /// Returns true for several strokes: then colours show strokes, not times.
    bool several() const noexcept { return starts_s.size() > 1; }

    timeline() = default;
    timeline(timeline&&) = default;
    timeline& operator=(timeline&&) = default;
};

timeline make_timeline(const scene& s);

/// Draws a strip of the colours of time, along x; in an animated picture a mark moves over it.
void draw_time_strip(canvas& c, box where);

/// Returns the colour of a burst: of its time if there is one stroke, of its stroke if there are several.
colour burst_colour(const timeline& t, const shown_burst& b) noexcept;

struct lane {
    std::vector<unsigned> tactors = {};
    std::string label = {}; ///< "4", "4 (7)" if channels have other numbers, "100-103"
};

inline constexpr double highest_level = 11.0; ///< pt

struct lanes {
    std::vector<lane> rows = {};
    std::vector<int> row_by_tactor = {}; ///< -1: does not play
    std::size_t levels = 1;              ///< levels of each row, one for each simultaneous stroke
    double height = 0.0;                 ///< height of one level, pt
    std::string heading = {};            ///< above the labels
    double label_width = 0.0;            ///< pt

    double row_height() const noexcept { return height * static_cast<double>(levels); }
    /// Returns the top of a row under that of the first, pt; of the row after the last, the height of all.
    double top(std::size_t row) const noexcept { return row_height() * static_cast<double>(row); }
    double all_height() const noexcept { return top(rows.size()); }

    /// Makes levels as high as possible in `space` pt, up to `highest` pt. Returns false if even the lowest
    /// levels need more.
    bool fit(double space, double highest = highest_level);
};

/// Makes the rows of the playing tactors, which have no height until they are fitted. `space`: for all rows,
/// pt.
lanes make_lanes(const array& a, const std::vector<unsigned>& playing, double space);

/// Draws labels, which end at x, for as many rows as there is space. `top`: of the first row. Returns a note
/// on labels without space; empty: all have space.
std::string draw_lane_labels(canvas& c, const lanes& l, double x, double top);

/// Range of the values in a column of the page.
struct column_range {
    float low = 0.0F;
    float high = 0.0F;
};

/// Returns the outlines of adjoining columns that are not 0, as closed shapes. The edges of the columns are
/// at x(0), x(1), ...
std::vector<std::vector<spot>> outline(const std::vector<column_range>& columns, const scale& x,
                                       const scale& y);

inline constexpr double column_width = 0.4; ///< pt

/// Height that draw_stroke_starts() needs over the diagram, pt; 0 for one stroke.
double starts_height(const timeline& t);

/// Draws a line at the start of each of several strokes, from over the diagram's top to its bottom, with the
/// numbers of all that start there. Returns a note on starts without space; empty: none.
std::string draw_stroke_starts(canvas& c, const timeline& t, const scale& x, double top, double bottom);

/// Draws number, colour and name of each stroke of a scene with several, in columns from the upper edge of a
/// box. Repeats share an entry. Returns the height that it took; 0 for one stroke. `colours`: the picture has
/// colours of strokes.
double draw_stroke_legend(canvas& c, const scene& s, const timeline& t, box where, bool colours);

} // namespace tactor::plot
