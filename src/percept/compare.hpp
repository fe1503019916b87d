// SPDX-License-Identifier: MIT
/// \file
/// Comparison of one stroke by several algorithms and phantom models: the prediction of how each feels, also
/// to many people who differ.
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

/// Number of drawn people, and ranges of their differences, which are evenly distributed.
struct spread_choice {
    unsigned people = 0; ///< 0: none
    std::uint64_t seed = 1;
    double sigma_factor = 2.0; ///< factor on sigma of low_speed, from 1 / this to this, evenly by ratio
    double threshold_db = 6.0; ///< each tactor's threshold, plus or minus
    double place_mm = 2.0;     ///< each tactor's place, anywhere within this distance
};

/// Returns a sentence about the ranges.
std::string spread_note(const spread_choice& c, bool by_taps);

/// Range between 5 and 95 % of the people.
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

/// Intervals of a row's figures; none for figures that its observer does not give.
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
    std::vector<speed_range> speeds = {};        ///< only for a picture
    std::vector<std::vector<point>> tracks = {}; ///< of the first people, only for a picture
};

/// Observer who feels the plans.
struct observer_choice {
    observer_kind kind = observer_kind::centroid;
    low_speed_observer low_speed = {};
};

/// Returns a sentence that explains the prediction, to print with its numbers.
std::string prediction_note(const observer_choice& o);

/// Prediction of how a plan feels.
struct prediction {
    percept_summary felt = {};    ///< of the centroid observer; low_speed sets only the errors, at the bursts
    tap_summary tapped = {};      ///< by low_speed
    std::vector<tap> taps = {};   ///< by low_speed
    std::string unpredicted = {}; ///< reason why low_speed has no prediction; empty: it has one
};

/// Predicts how a plan of a stroke feels. For the centroid, passes each sample to `each`, without its speed.
/// \throws error (bad_input) as predict_percept() and predict_taps().
prediction predict(const array& a, const stroke& s, const plan& p, const observer_choice& o,
                   const std::function<void(const percept_sample&)>& each);

/// An algorithm with a phantom model: a plan, or the reason why there is none.
struct comparison_row : prediction {
    algorithm_kind algorithm = algorithm_kind::park2016;
    phantom_kind phantom = phantom_kind::inverse_distance;
    std::optional<tactor::plan> plan = {};
    std::vector<percept_sample> samples = {}; ///< by the centroid, only on request
    std::optional<row_spread> spread = {};    ///< with drawn people, if there is a prediction
    std::optional<error> refused = {};        ///< refusal, in the words of the library
};

struct comparison {
    stroke target;
    observer_choice observer = {};
    bool compensated = false;
    spread_choice spread = {};
    faces_kind faces = faces_kind::delaunay; ///< for inverse_distance, except tactile_brush
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
    bool compensate = false; ///< for observer.low_speed
    bool keep_samples = false;
    spread_choice spread = {};
    std::function<void()> after_person = [] {}; ///< called after each person whose percept is predicted
};

/// Plans and predicts with every algorithm and every model, in this order. An algorithm that cannot play the
/// stroke becomes a row with the reason.
/// \throws errors other than bad_input.
comparison compare(const stroke& target, const array& a, const layout& faces, const plan_options& options,
                   const comparison_choice& choice);

} // namespace tactor::detail
