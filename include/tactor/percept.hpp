// SPDX-License-Identifier: MIT
/// \file
/// Prediction of what a plan feels like (rendering model, section 9). It is a model, never a measurement.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/path.hpp>
#include <tactor/phantom.hpp>
#include <tactor/plan.hpp>
#include <tactor/stroke.hpp>

namespace tactor {
inline namespace v0 {

/// Target and predicted percept at one instant.
struct percept_sample {
    double t_s = 0.0;
    point target = {};
    /// Energy centroid of the tactors that sound; none in silence.
    std::optional<point> felt = {};
    double intensity = 0.0; ///< square root of the summed energy, linear
    double target_intensity = 1.0;
    bool shared = false; ///< a tactor serves two bursts at once
    /// Speed of the felt position, smoothed over percept_window_s. None if this window begins before the
    /// first felt position, or extends beyond the movement.
    std::optional<double> speed_mm_s = {};
};

/// Distance of the prediction from the target.
struct percept_summary {
    /// RMS distance between the felt place and the target at the same time. If nothing is felt, this value
    /// and all other optional values are none.
    std::optional<double> rms_error_mm = {};
    std::optional<double> largest_error_mm = {};
    /// Time by which the felt path lags behind the target. Of the lags from 0 to longest_lag_s in steps of
    /// percept_step_s, it is the lag with the least RMS error. If errors are equal, the shortest lag counts.
    /// Before the stroke begins, the target counts as at its first place.
    std::optional<double> lag_s = {};
    std::optional<double> rms_at_lag_mm = {};
    /// Parts of the error at the same time: along the direction of the target's movement, and across it.
    /// While the target rests, the direction of its last movement counts, or of its first if it has not moved
    /// yet. None if the target never moves.
    std::optional<double> along_rms_mm = {};
    std::optional<double> along_max_mm = {};
    std::optional<double> across_rms_mm = {};
    std::optional<double> across_max_mm = {};
    /// RMS distance from the felt place to the nearest point of the path through the samples' targets.
    std::optional<double> rms_to_path_mm = {};
    /// Coefficient of variation (standard deviation / mean) of speed. None for a movement that is too short
    /// to have a speed, or in which no motion is felt.
    std::optional<double> speed_cv = {};
    /// Coefficient of variation of intensity; silence has intensity 0. None if nothing is felt.
    std::optional<double> intensity_cv = {};
    double silent_share = 0.0; ///< share of the time without a sounding tactor, 0 ... 1
    double shared_share = 0.0; ///< share of the time in which a tactor serves two bursts at once, 0 ... 1
};

/// Interval of the samples, s.
inline constexpr double percept_step_s = 0.001;
/// Width of the centred moving average, s: 50 samples on either side of the middle one.
inline constexpr double percept_window_s = 0.1;
/// Longest lag of percept_summary, s.
inline constexpr double longest_lag_s = 0.2;
/// Longest movement that can be predicted, s.
inline constexpr double longest_percept_s = 3600.0;

/// Difference of one person from the person for whom the plan was made.
struct person {
    /// Change of the person's sensitivity at each tactor, dB; below 0 if the threshold is higher than
    /// assumed. Empty: no difference.
    std::vector<double> sensitivity_db = {};
    /// Shift of each tactor from its assumed place to the place where it is felt, mm. Empty: no difference.
    std::vector<point> shift = {};
};

/// Predicts the percept at 0, 1, 2 ... ms until the end of the stroke. The last sample is at the end of the
/// stroke if the end is a multiple of 1 ms (within 1 ns), else at the last multiple before the end. `p` must
/// be a plan of `s` on `a`. `who` describes a person other than the one for whom the plan was made.
///
/// A burst sounds from its onset until just before its end (within 1 ns). A burst that ends with the movement
/// also sounds at its end, unless another burst begins then. Where bursts overlap on one tactor,
/// plan::overlap says how to combine them.
///
/// For the speed, the last felt position is held during silence. The positions are averaged over
/// percept_window_s, and the speed is the central difference of these averages.
///
/// O(samples * log n) for a stroke of n points. The time for a burst does not depend on the number of bursts
/// that overlap with it. An hour has 3,600,001 samples, which take 317 MB. follow_percept() stores no
/// samples. summarise() stores only their targets, which take 65 MB.
///
/// \throws error (bad_input) if the stroke is longer than longest_percept_s, if the plan names a tactor that
///         the array does not have, and if a list in `who` is not empty and does not have one finite value
///         for each tactor.
[[nodiscard]] TACTOR_API std::vector<percept_sample> predict_percept(const array& a, const stroke& s,
                                                                     const plan& p, const person& who = {});

/// Predicts the same samples as predict_percept(), and passes each of them to `each` as soon as its speed is
/// known. Calls `each` in order, in the calling thread. Memory does not grow with the length of the stroke.
/// \throws error as predict_percept() does. Throws for a tactor that the array does not have when the plan
///         reaches this tactor, and for everything else before the first sample. Exceptions from `each` pass
///         through.
TACTOR_API void follow_percept(const array& a, const stroke& s, const plan& p, const person& who,
                               const std::function<void(const percept_sample&)>& each);

/// Summarises samples. Errors and speed count only while something is felt. Standard deviations are
/// population standard deviations (divided by n). O(n log n) for n samples if the path does not return to
/// earlier places.
[[nodiscard]] TACTOR_API percept_summary summarise(const std::vector<percept_sample>& samples);

/// Summarises all samples of predict_percept() without storing them.
/// \throws error as predict_percept().
[[nodiscard]] TACTOR_API percept_summary summarise(const array& a, const stroke& s, const plan& p,
                                                   const person& who = {});

/// Goldreich's Bayesian observer (PLoS ONE 2007; Goldreich and Tong 2013). The observer's error in localising
/// a tap has standard deviation sigma_mm. The prior of the speed has mean 0 and standard deviation
/// sigma_v_mm_s. The model was built for taps on the forearm, with a sigma of 10 mm; the default of 5 mm is
/// an assumption. Nobody has fitted the model to the palm, or to bursts without a gap between them.
struct low_speed_observer {
    double sigma_mm = 5.0;       ///< least_sigma_mm to most_sigma_mm
    double sigma_v_mm_s = 100.0; ///< least_sigma_v_mm_s to most_sigma_v_mm_s

    friend bool operator==(const low_speed_observer&, const low_speed_observer&) = default;
};

inline constexpr double least_sigma_mm = 0.001;
inline constexpr double most_sigma_mm = 1000.0;
inline constexpr double least_sigma_v_mm_s = 0.001;
inline constexpr double most_sigma_v_mm_s = 1e6;

/// Returns a sentence about the model, its parameters and its purpose, to print with the model's numbers.
[[nodiscard]] TACTOR_API std::string describe(const low_speed_observer& o);

/// Returns the places where taps are felt. The taps begin at `onsets_s` (ascending). `alone` are the places
/// where each tap would be felt if it were the only one. The result is the x that minimises
///
///     sum |alone_i - x_i|^2 / sigma^2 + sum |x_(i+1) - x_i|^2 / (sigma_v (t_(i+1) - t_i))^2
///
/// Taps with equal onsets are felt at one place. O(n), and exact except for rounding. Any thread.
/// \throws error (bad_input) for parameters out of bounds, lists of different lengths, numbers that are not
///         finite, and onsets that do not ascend.
[[nodiscard]] TACTOR_API std::vector<point>
felt_places(const low_speed_observer& o, std::span<const double> onsets_s, std::span<const point> alone);

/// A burst as a tap.
struct tap {
    double onset_s = 0.0;
    point target = {}; ///< the target's place at the onset
    point alone = {};  ///< centre of energy of the drives: the place where this burst is felt alone
    point felt = {};

    friend bool operator==(const tap&, const tap&) = default;
};

/// Distance of the prediction from the target, at the bursts.
struct tap_summary {
    std::optional<double> rms_error_mm = {};     ///< none without taps
    std::optional<double> largest_error_mm = {}; ///< none without taps
    double felt_length_mm = 0.0;                 ///< length of the line through the felt places
    double target_length_mm = 0.0;               ///< length of the line through the targets
    /// felt_length_mm / target_length_mm; none if the target rests.
    std::optional<double> length_ratio = {};
};

/// Predicts where the observer feels a plan's bursts. Bursts without drives are not felt. `p` must be a plan
/// of `s` on `a`. `who` describes a person other than the one for whom the plan was made. O(n log m) for n
/// bursts and a stroke of m points.
/// \throws error (bad_input) as felt_places() does, and as predict_percept() does for `who`.
/// \throws error (bad_input) for a continuous plan, for which the observer has no prediction, and for a plan
///         that names a tactor that the array does not have.
[[nodiscard]] TACTOR_API std::vector<tap> predict_taps(const array& a, const stroke& s, const plan& p,
                                                       const low_speed_observer& o = {},
                                                       const person& who = {});

/// Summarises taps.
[[nodiscard]] TACTOR_API tap_summary summarise(const std::vector<tap>& taps);

/// Places at which taps must be played so that the observer feels them at their targets.
struct compensated_places {
    std::vector<point> played = {}; ///< in the hull of the array
    std::vector<point> felt = {};   ///< equal to the targets if `at_edge` is 0
    std::size_t at_edge = 0;        ///< taps that could not be moved far enough

    friend bool operator==(const compensated_places&, const compensated_places&) = default;
};

/// Computes the places m at which taps must be played so that they are felt at the targets x:
///
///     m = (I + K) x
///
/// If some m_i lies outside the array, the result is the m in the array's hull that minimises sum |x(m) -
/// x|^2. The solver of this convex problem stops when ten steps change the sum by less than 1e-12 of its
/// value. If the minimum is flat, as with strong links between taps, another solver may find other places
/// that are felt in the same way. O(n) for n taps if all m_i lie on the array. Otherwise the solver takes
/// some 50 to 2000 steps of O(n). It takes at most 5000 steps, and for long chains of taps at most ten
/// million divided by n. Any thread.
/// \throws error (bad_input) as felt_places() does, for taps that begin at the same time or nearly so for the
///         observer (a link k above ten million), and for more than a million taps if some m_i lies outside
///         the array.
[[nodiscard]] TACTOR_API compensated_places compensate(const layout& l, const low_speed_observer& o,
                                                       std::span<const double> onsets_s,
                                                       std::span<const point> targets);

/// A plan with its bursts moved so that the observer feels the target.
struct compensated_plan {
    tactor::plan plan = {};
    low_speed_observer observer = {};
    std::vector<tap> taps = {}; ///< predict_taps() of the plan
    std::size_t at_edge = 0;    ///< as in compensated_places
    /// Distance of the felt places from the target, if each burst alone is felt exactly at its own point.
    double residual_rms_mm = 0.0;
    double residual_largest_mm = 0.0;

    friend bool operator==(const compensated_plan&, const compensated_plan&) = default;
};

/// Plans as make_plan() does, then moves the bursts for the observer. Assumes that each burst alone is felt
/// at its own point, which is true for phantom_kind::barycentric. With other phantoms, the distance from that
/// point to the centre of energy adds to the error. A warning in the plan says that bursts were moved, and
/// how large the remaining error is.
/// \throws error (bad_input) as make_plan() and compensate() do, and for `continuous`.
[[nodiscard]] TACTOR_API compensated_plan make_compensated_plan(const array& a, const layout& l,
                                                                const stroke& s, const plan_options& o,
                                                                const low_speed_observer& m = {});

} // namespace v0
} // namespace tactor
