// SPDX-License-Identifier: MIT
/// \file
/// Comparison of several algorithms and phantom models for one stroke. Predicts how each combination feels,
/// also to many different people.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Number of people to draw at random, and ranges of the differences between them. Differences are uniformly
/// distributed.
struct spread_choice {
    unsigned people = 0; ///< 0 to draw nobody
    std::uint64_t seed = 1;
    double sigma_factor = 2.0; ///< factor on sigma of low_speed: log-uniform from 1 / this to this
    double threshold_db = 6.0; ///< greatest change of a tactor's threshold, up or down
    double place_mm = 2.0;     ///< greatest distance by which the place of a tactor changes
};

/// Returns a sentence about the ranges.
std::string spread_note(const spread_choice& c, bool by_taps);

/// Range from the 5 % to the 95 % quantile of the people.
struct interval {
    double low = 0.0;
    double high = 0.0;
};

/// Band of a speed chart at one time.
struct speed_range {
    double t_s = 0.0;
    double low = 0.0;
    double high = 0.0;
};

/// Intervals of the figures of a row. Missing for figures that the observer does not have.
struct row_spread {
    std::optional<interval> rms_error_mm = {};
    std::optional<interval> largest_error_mm = {};
    std::optional<interval> lag_s = {};
    std::optional<interval> rms_at_lag_mm = {};
    std::optional<interval> along_rms_mm = {};
    std::optional<interval> along_max_mm = {};
    std::optional<interval> across_rms_mm = {};
    std::optional<interval> across_max_mm = {};
    std::optional<interval> rms_to_path_mm = {};
    std::optional<interval> speed_cv = {};
    std::optional<interval> intensity_cv = {};
    std::optional<interval> felt_length_mm = {};
    std::optional<interval> length_ratio = {};
    std::vector<speed_range> speeds = {};        ///< range of speeds over time, only for a picture
    std::vector<std::vector<point>> tracks = {}; ///< felt paths of the first people, only for a picture
};

/// Observer for which the percept of plans is predicted.
struct observer_choice {
    observer_kind kind = observer_kind::centroid;
    low_speed_observer low_speed = {};
};

/// Returns a sentence that explains the prediction, to print with the numbers.
std::string prediction_note(const observer_choice& o);

/// Prediction of how a plan feels.
struct prediction {
    percept_summary felt = {}; ///< percept of the centroid observer; low_speed sets only the errors at bursts
    tap_summary tapped = {};   ///< summary of `taps`
    std::vector<tap> taps = {};   ///< prediction of low_speed
    std::string unpredicted = {}; ///< reason why low_speed has no prediction; empty if it has one
};

/// Predicts how a plan of a stroke feels. If the observer is the centroid, passes each sample to `each`,
/// without the speed. \throws error (bad_input) as predict_percept() and predict_taps().
prediction predict(const array& a, const stroke& s, const plan& p, const observer_choice& o,
                   const std::function<void(const percept_sample&)>& each);

/// An algorithm with a phantom model: a plan, or the reason why there is none.
struct comparison_row : prediction {
    algorithm_kind algorithm = algorithm_kind::park2016;
    phantom_kind phantom = phantom_kind::inverse_distance;
    std::optional<tactor::plan> plan = {};
    std::vector<percept_sample> samples = {}; ///< samples of the centroid observer, only on request
    std::optional<row_spread> spread = {};    ///< spread over drawn people, if there is a prediction
    std::optional<error> refused = {};        ///< error that prevented the plan or the prediction
};

struct comparison {
    stroke target;
    observer_choice observer = {};
    bool compensated = false;
    spread_choice spread = {};
    faces_kind faces = faces_kind::delaunay; ///< used by inverse_distance, except with tactile_brush
    std::vector<comparison_row> rows = {};

    /// Returns true if any algorithm can play the stroke.
    bool playable() const;
    /// Returns true if any row has figures.
    bool predicted() const;
};

/// Algorithms, models and observer of a comparison.
struct comparison_choice {
    std::vector<algorithm_kind> algorithms = {};
    std::vector<phantom_kind> phantoms = {};
    observer_choice observer = {};
    bool compensate = false; ///< true to move bursts for observer.low_speed
    bool keep_samples = false;
    spread_choice spread = {};
    std::function<void()> after_person = [] {}; ///< called after each person whose percept is predicted
};

/// Plans and predicts with each algorithm and each model, in this order. A combination that cannot play the
/// stroke gets a row with the error.
/// \throws errors other than bad_input.
comparison compare(const stroke& target, const array& a, const layout& faces, const plan_options& options,
                   const comparison_choice& choice);

} // namespace tactor::detail
