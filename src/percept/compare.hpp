// SPDX-License-Identifier: MIT
/// \file
/// Comparison of one stroke by several algorithms and phantom models: the prediction of how each feels.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

#include "percept/spread.hpp"

namespace tactor::detail {

/// Observer who feels the plans.
struct observer_choice {
    observer_kind kind = observer_kind::centroid;
    low_speed_observer low_speed = {};
};

/// Returns a sentence that explains the prediction, to print with its numbers.
std::string prediction_note(const observer_choice& o);

/// Prediction of how a plan feels.
struct prediction {
    percept_summary felt = {};    ///< of the centroid observer; low_speed sets only the errors
    tap_summary tapped = {};      ///< by low_speed
    std::vector<tap> taps = {};   ///< by low_speed
    std::string unpredicted = {}; ///< reason why low_speed has no prediction; empty: it has one
};

/// Returns summarise() of predict_percept() for each plan, equal to the last bit. Stores no samples, and
/// looks the target up once for all plans. Passes the samples of each plan to `each`, without their speeds.
/// \throws error (bad_input) as predict_percept().
std::vector<percept_summary> predict_summaries(const array& a, const stroke& s,
                                               std::span<const plan* const> plans,
                                               const std::function<void(const percept_sample&)>& each = {});

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
