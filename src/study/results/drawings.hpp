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
    double distance_mm = 0.0;             ///< mean distance between corresponding points of both paths
    double frechet_mm = 0.0;              ///< discrete Frechet distance between the same points
    std::optional<double> length = {};    ///< drawn length / target length; missing if the target length is 0
    std::optional<double> direction = {}; ///< angle from the target's chord to the drawn chord, -180 to 180
                                          ///< degrees; missing if a path returns to its start
    std::optional<double> curvature = {}; ///< drawn minus target, 1/m; missing if a path has no length
};

/// Compares a path with its target. Angles and curvatures are positive from +x towards +y.
/// \pre Both drawings have a point.
path_errors compare_paths(const drawing& drawn, const drawing& target);

/// Returns the mean curvature, 1/m: divides the drawing into five parts of equal length, and divides the sum
/// of the turns between the parts by four fifths of the length. Returns nothing if the length is 0.
std::optional<double> find_curvature(const drawing& d);

/// Lists a participant's figures, the main figure first. If there are no trials, lists names without values.
///
/// For places, mm: error is the mean distance. constant_along (y) and constant_across (x) are means of drawn
/// minus target. variable_along and variable_across are standard deviations within motions.
///
/// For paths: means of distance, frechet, length, direction (circular) and curvature over the trials.
std::vector<named_value> list_drawn_figures(drawing_kind kind, const std::vector<trial>& trials);

/// Measures the drawings of each participant in a condition. For a single motion, also returns the target and
/// the mean drawing. For a single motion and a single method, also returns the predictions.
drawn_answers measure_drawings(const run_outline& o, drawing_kind kind, const condition_trials& c,
                               const run_people& people);

/// Counts, for each method and motion, how often each motion's target was nearest to the drawn place.
std::vector<answer_counts> count_nearest_targets(const run_outline& o, const run_people& people);

} // namespace tactor::study
