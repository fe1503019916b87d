// SPDX-License-Identifier: MIT
/// \file
/// Figures of drawings: how far the places and paths that participants draw are from their targets.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "study/data/drawing.hpp"
#include "study/results/measures.hpp"
#include "study/results/result.hpp"

namespace tactor::study {

/// Differences between a drawn path and its target.
struct path_errors {
    double distance_mm = 0.0;             ///< mean distance at drawn_parts equal parts of the lengths
    double frechet_mm = 0.0;              ///< discrete Frechet distance between the same points
    std::optional<double> length = {};    ///< ratio of the lengths; missing if the target has none
    std::optional<double> direction = {}; ///< angle from the target's chord to the drawn one, -180 to 180
                                          ///< degrees; missing if one of them returns to its start
    std::optional<double> curvature = {}; ///< drawn minus target, 1/m; missing if one has no length
};

/// Compares a path with its target. Angles and curvatures are positive from +x towards +y.
/// \pre Both have a point.
path_errors compare_paths(const drawing& drawn, const drawing& target);

/// Returns the mean curvature, 1/m: the sum of the turns between five equal parts of the length, over four
/// fifths of the length. Missing without a length.
std::optional<double> find_curvature(const drawing& d);

/// Lists a participant's figures, the main figure first. Without trials lists only the names.
///
/// Places, mm: error (mean distance), constant_along (y) and constant_across (x): means of drawn minus
/// target; variable_along and variable_across: standard deviations within motions.
///
/// Paths: means of distance, frechet, length, direction (circular) and curvature over the trials.
std::vector<named_value> list_drawn_figures(drawing_kind kind, const std::vector<trial>& trials);

/// Measures the drawings of each participant in a condition. With one motion it also has the target and the
/// mean drawing, and with one method the predictions.
drawn_answers measure_drawings(const run_outline& o, drawing_kind kind, const condition_trials& c,
                               const run_people& people);

/// Counts by method and motion the motion whose target is nearest to the place drawn.
std::vector<answer_counts> count_nearest(const run_outline& o, const run_people& people);

} // namespace tactor::study
