// SPDX-License-Identifier: MIT
/// \file
/// What a plan is predicted to feel like (rendering model, section 9): a model, never a measurement.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

namespace tactor {
inline namespace v0 {

/// One instant: where the target is, and what is predicted to be felt.
struct percept_sample {
    double t_s = 0.0;
    point target = {};
    /// Energy centroid of the tactors that sound; none while none does.
    std::optional<point> felt = {};
    double intensity = 0.0; ///< square root of the summed energy, linear
    double target_intensity = 1.0;
    bool shared = false; ///< a tactor serves two bursts
    /// Speed of the felt position, smoothed over percept_window_s. None where this window would reach out of
    /// the movement, or back to a time before anything was felt.
    std::optional<double> speed_mm_s = {};
};

/// How far the prediction is from the target.
struct percept_summary {
    std::optional<double> rms_error_mm = {};     ///< none where nothing is felt
    std::optional<double> largest_error_mm = {}; ///< none where nothing is felt
    /// Coefficient of variation (standard deviation / mean) of speed; none for a movement that is too short
    /// to have a speed, or that is not felt to move.
    std::optional<double> speed_cv = {};
    /// The same of intensity, silence being intensity 0; none where nothing is felt.
    std::optional<double> intensity_cv = {};
    double silent_share = 0.0; ///< share of the time without a sounding tactor, 0 ... 1
    double shared_share = 0.0; ///< share of the time in which one tactor serves two bursts, 0 ... 1
};

/// Interval of the samples.
inline constexpr double percept_step_s = 0.001;
/// Width of the centred moving average: 50 samples on either side of the one in the middle.
inline constexpr double percept_window_s = 0.1;
/// The longest movement that is looked at, s.
inline constexpr double longest_percept_s = 3600.0;

/// How one person differs from the one for whom the plan was made.
struct person {
    /// By tactor: how much more strongly it is felt, dB; below 0 where the threshold is higher than assumed.
    /// Empty: no difference.
    std::vector<double> sensitivity_db = {};
    /// By tactor: from its assumed place to the place where it is felt, mm. Empty: no difference.
    std::vector<point> shift = {};
};

/// What is felt at 0, 1, 2 ... ms, as long as the target moves. The last sample is at the end of the stroke
/// if that is a multiple of 1 ms (within 1 ns), else just before it. `p` must be a plan of `s` on `a`; `who`
/// is another person than the one for whom it was made.
///
/// A burst sounds from its onset until before its end (within 1 ns). There is one exception: a burst that
/// ends with the movement still counts at that time, unless another begins there. Bursts that overlap on one
/// tactor are joined as the plan says (plan::overlap).
///
/// Speed: where nothing sounds, the position felt last is held. The positions completed in this way are
/// averaged over percept_window_s; speed is the central difference of the average.
///
/// O(samples * log n) for a stroke of n points, and O(1) for each burst in as many as overlap with it. An
/// hour is 3,600,001 samples, 317 MB: follow_percept() and summarise() keep none.
///
/// \throws error (bad_input) where the stroke is longer than longest_percept_s, the plan names a tactor that
///         the array does not have, or a list of `who` is neither empty nor has one finite number for each
///         tactor.
[[nodiscard]] TACTOR_API std::vector<percept_sample> predict_percept(const array& a, const stroke& s,
                                                                     const plan& p, const person& who = {});

/// The same samples, each handed to `each` in the calling thread, in order, once its speed is known. Memory
/// does not grow with the length of the stroke.
/// \throws error as predict_percept(): before the first sample; for a tactor that the array does not have,
///         when the plan comes to it. Exceptions from `each` come through.
TACTOR_API void follow_percept(const array& a, const stroke& s, const plan& p, const person& who,
                               const std::function<void(const percept_sample&)>& each);

/// Sums samples up. Errors and speed count only where something is felt. Standard deviations are those of the
/// population (divided by n).
[[nodiscard]] TACTOR_API percept_summary summarise(const std::vector<percept_sample>& samples);

/// Sums up all samples of predict_percept() without keeping them. \throws error as predict_percept().
[[nodiscard]] TACTOR_API percept_summary summarise(const array& a, const stroke& s, const plan& p,
                                                   const person& who = {});

} // namespace v0
} // namespace tactor
