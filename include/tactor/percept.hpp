// SPDX-License-Identifier: MIT
/// \file
/// What a plan is predicted to feel like (rendering model, section 9): a model, never a measurement.
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

/// Goldreich's observer (PLoS ONE 2007; Goldreich and Tong 2013): knows places to sigma_mm and expects speeds
/// of 0 give or take sigma_v_mm_s. The defaults were fitted to taps on the forearm; nobody has fitted a palm,
/// or bursts that touch.
struct low_speed_observer {
    double sigma_mm = 5.0;       ///< least_sigma_mm to most_sigma_mm
    double sigma_v_mm_s = 100.0; ///< least_sigma_v_mm_s to most_sigma_v_mm_s

    friend bool operator==(const low_speed_observer&, const low_speed_observer&) = default;
};

inline constexpr double least_sigma_mm = 0.001;
inline constexpr double most_sigma_mm = 1000.0;
inline constexpr double least_sigma_v_mm_s = 0.001;
inline constexpr double most_sigma_v_mm_s = 1e6;

/// The model, its parameters and what it was built for, in a sentence that goes with its numbers.
[[nodiscard]] TACTOR_API std::string describe(const low_speed_observer& o);

/// Where taps are felt. They begin at `onsets_s` (ascending); each by itself would be felt at `alone`. The
/// result is the x that minimises
/// sum |alone_i - x_i|^2 / sigma^2 + sum |x_(i+1) - x_i|^2 / (sigma_v (t_(i+1) - t_i))^2.
/// Taps at the same time are felt at one place. O(n), and exact to rounding. Any thread.
/// \throws error (bad_input) for parameters out of bounds, lists of different lengths, numbers that are not
///         finite, and onsets that do not ascend.
[[nodiscard]] TACTOR_API std::vector<point>
felt_places(const low_speed_observer& o, std::span<const double> onsets_s, std::span<const point> alone);

/// One burst as a tap.
struct tap {
    double onset_s = 0.0;
    point target = {}; ///< where the target is at the onset
    point alone = {};  ///< centre of energy of the burst's drives: where it would be felt by itself
    point felt = {};

    friend bool operator==(const tap&, const tap&) = default;
};

/// How far the prediction is from the target, at the bursts.
struct tap_summary {
    std::optional<double> rms_error_mm = {};     ///< none without taps
    std::optional<double> largest_error_mm = {}; ///< none without taps
    double felt_length_mm = 0.0;                 ///< of the chain of the places felt
    double target_length_mm = 0.0;               ///< of the chain of the target's places
    /// The first by the second; none where the target rests.
    std::optional<double> length_ratio = {};
};

/// What the observer feels of a plan's bursts; those without drives are not felt. `p` must be a plan of `s`
/// on `a`. O(n log m) in n bursts and the m points of the stroke.
/// \throws error (bad_input) as felt_places() does, for a continuous plan, for which the observer has no
///         prediction, and for a plan that names a tactor that the array does not have.
[[nodiscard]] TACTOR_API std::vector<tap> predict_taps(const array& a, const stroke& s, const plan& p,
                                                       const low_speed_observer& o = {});

/// The same for another person. \throws error (bad_input) as predict_percept() does for a person.
[[nodiscard]] TACTOR_API std::vector<tap> predict_taps(const array& a, const stroke& s, const plan& p,
                                                       const low_speed_observer& o, const person& who);

/// Sums taps up.
[[nodiscard]] TACTOR_API tap_summary summarise(const std::vector<tap>& taps);

/// Where to play taps so that the observer feels them at their targets.
struct compensated_places {
    std::vector<point> played = {}; ///< in the hull of the array
    std::vector<point> felt = {};   ///< at their targets, where `at_edge` is 0
    std::size_t at_edge = 0;        ///< how many could not be moved far enough

    friend bool operator==(const compensated_places&, const compensated_places&) = default;
};

/// The places at which taps must be played to be felt at x: m = (I + K) x. Where some m_i lies outside the
/// array, the result is the m in its hull that minimises sum |x(m) - x|^2: a convex problem, solved until the
/// sum is within 1e-15 of its least (2e-10 where links are very strong), in units of the array's size
/// squared. O(n) in taps where all fit, else O(n h) in the h corners of the hull, some twenty times. Any
/// thread.
/// \throws error (bad_input) as felt_places() does, for taps that begin together, for more than 4 million
///         taps times corners, and where taps are pulled too strongly for an answer (k of ten million and
///         more).
[[nodiscard]] TACTOR_API compensated_places compensate(const layout& l, const low_speed_observer& o,
                                                       std::span<const double> onsets_s,
                                                       std::span<const point> targets);

/// A plan that is moved so that the observer feels the target.
struct compensated_plan {
    tactor::plan plan = {};
    low_speed_observer observer = {};
    std::vector<tap> taps = {}; ///< predict_taps() of the plan
    std::size_t at_edge = 0;    ///< as in compensated_places
    /// How far the places felt are from the target, if each burst by itself is felt exactly at its own point.
    double residual_rms_mm = 0.0;
    double residual_largest_mm = 0.0;

    friend bool operator==(const compensated_plan&, const compensated_plan&) = default;
};

/// Plans as make_plan() does, then moves the bursts for the observer. It takes each burst by itself to be
/// felt at its own point, as it is with phantom_kind::barycentric; with other phantoms, the distance from
/// that point to the centre of energy is added to the error. One of the plan's warnings says that bursts are
/// moved, and what error is left.
/// \throws error (bad_input) as make_plan() and compensate() do, and for `continuous`.
[[nodiscard]] TACTOR_API compensated_plan make_compensated_plan(const array& a, const layout& l,
                                                                const stroke& s, const plan_options& o,
                                                                const low_speed_observer& m = {});

} // namespace v0
} // namespace tactor
