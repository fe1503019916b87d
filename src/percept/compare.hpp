// SPDX-License-Identifier: MIT
/// \file
/// One stroke by several algorithms and phantom models: what each is predicted to feel like.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

#include "percept/spread.hpp"

namespace tactor::detail {

/// Who feels it.
struct observer_choice {
    observer_kind kind = observer_kind::centroid;
    low_speed_observer low_speed = {};
};

/// Says in a sentence, to go with the numbers, what the prediction is.
std::string prediction_note(const observer_choice& o);

/// One algorithm with one phantom model. Either a plan, or why there is none.
struct comparison_row {
    algorithm_kind algorithm = algorithm_kind::park2016;
    phantom_kind phantom = phantom_kind::inverse_distance;
    std::optional<tactor::plan> plan = {};
    percept_summary felt = {};                ///< of the centroid; of low-speed the errors alone
    std::vector<percept_sample> samples = {}; ///< of the centroid, only where asked for
    tap_summary tapped = {};                  ///< of low-speed
    std::vector<tap> taps = {};               ///< the same
    std::string unpredicted = {};             ///< why low-speed has no prediction; empty where it has
    std::optional<row_spread> spread = {};    ///< with people drawn, where there is a prediction
    std::optional<error> refused = {};        ///< in the words of the library
};

struct comparison {
    stroke target;
    observer_choice observer = {};
    bool compensated = false;
    spread_choice spread = {};
    faces_kind faces = faces_kind::delaunay; ///< of inverse-distance, but for tactile-brush
    std::vector<comparison_row> rows = {};

    /// Whether any algorithm can play it.
    bool playable() const;
};

/// What is compared with what.
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
/// stroke becomes a row that says why. \throws what is not bad input.
comparison compare(const stroke& given, const array& a, const layout& faces, const plan_options& options,
                   const comparison_choice& choice);

} // namespace tactor::detail
