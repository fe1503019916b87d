// SPDX-License-Identifier: MIT
/// \file
/// What a plan is predicted to feel like: a model, never a measurement.
#pragma once

#include <optional>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

namespace tactor {

/// One instant: where the target is, and what is predicted to be felt.
struct percept_sample {
    double t_s = 0.0;
    point target = {};
    /// Energy centroid of the tactors that sound; none while none does.
    std::optional<point> felt = {};
    double intensity = 0.0; ///< square root of the summed energy, linear
    double target_intensity = 1.0;
    bool shared = false;     ///< a tactor serves two bursts
    double speed_mm_s = 0.0; ///< of the felt position, smoothed over 0.1 s
};

/// How far the prediction is from the target.
struct percept_summary {
    double rms_error_mm = 0.0;
    double largest_error_mm = 0.0;
    double speed_cv = 0.0;     ///< coefficient of variation (standard deviation / mean) of speed
    double intensity_cv = 0.0; ///< the same of intensity
    double silent_share = 0.0; ///< share of the time without a sounding tactor, 0 ... 1
    double shared_share = 0.0; ///< share of the time in which one tactor serves two bursts, 0 ... 1
};

/// Interval of the samples.
inline constexpr double percept_step_s = 0.001;

/// Samples each millisecond from 0 to the end of the target's movement. `p` must be a plan of `s` on `a`.
/// \throws error (bad_input) where the movement has more than 10 million samples.
TACTOR_API std::vector<percept_sample> predict_percept(const array& a, const stroke& s, const plan& p);

/// Sums samples up. Errors and speed count only where something is felt.
TACTOR_API percept_summary summarise(const std::vector<percept_sample>& samples);

} // namespace tactor
