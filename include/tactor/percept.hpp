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
    bool shared = false; ///< a tactor serves two bursts
    /// Speed of the felt position, smoothed over percept_window_s. None if this window extends beyond the
    /// movement, or to before the first felt position.
    std::optional<double> speed_mm_s = {};
};

/// Distance of the prediction from the target.
struct percept_summary {
    /// Distance at equal times from the felt place to the target. None if nothing is felt, as the others.
    std::optional<double> rms_error_mm = {};
    std::optional<double> largest_error_mm = {};
    /// Time from the target to the felt path: the lag, of 0 ... longest_lag_s in steps of percept_step_s, at
    /// which the RMS error is least; the shortest of equal ones. Before its start the target is at its start.
    std::optional<double> lag_s = {};
    std::optional<double> rms_at_lag_mm = {};
    /// Parts of the error at equal times along the target's movement and across it. While the target rests,
    /// its last movement counts, or else its first. None if it never moves.
    std::optional<double> along_rms_mm = {};
    std::optional<double> along_max_mm = {};
    std::optional<double> across_rms_mm = {};
    std::optional<double> across_max_mm = {};
    /// Distance from the felt place to the nearest point of the path through the samples' targets.
    std::optional<double> rms_to_path_mm = {};
    /// Coefficient of variation (standard deviation / mean) of speed. None for a movement that is too short
    /// to have a speed, or that is not felt to move.
    std::optional<double> speed_cv = {};
    /// Coefficient of variation of intensity; silence has intensity 0. None if nothing is felt.
    std::optional<double> intensity_cv = {};
    double silent_share = 0.0; ///< share of the time without a sounding tactor, 0 ... 1
    double shared_share = 0.0; ///< share of the time in which one tactor serves two bursts, 0 ... 1
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
    /// Gain in sensitivity of each tactor, dB; below 0 if its threshold is higher than assumed. Empty: no
    /// difference.
    std::vector<double> sensitivity_db = {};
    /// Shift of each tactor from its assumed place to the place where it is felt, mm. Empty: no difference.
    std::vector<point> shift = {};
};

/// Predicts the percept at 0, 1, 2 ... ms, as long as the target moves. The last sample is at the end of the
/// stroke if that is a multiple of 1 ms (within 1 ns), else just before it. `p` must be a plan of `s` on `a`.
/// `who`: the person who feels it, if not the one for whom it was made.
///
/// A burst sounds from its onset to its end, its end excluded (within 1 ns). The exception is a burst that
/// ends with the movement: it still counts at that time, unless another begins there. plan::overlap joins
/// bursts that overlap on one tactor.
///
/// Speed: in silence, the last felt position is held. These positions are averaged over percept_window_s, and
/// speed is the central difference of the average.
///
/// O(samples * log n) for a stroke of n points, and for each burst O(1) in the number of bursts that overlap
/// with it. An hour has 3,600,001 samples, 317 MB. follow_percept() keeps none, and summarise() only their
/// targets, 65 MB.
///
/// \throws error (bad_input) if the stroke is longer than longest_percept_s, if the plan names a tactor that
///         the array does not have, and if a list of `who` is neither empty nor one finite number for each
///         tactor.
[[nodiscard]] TACTOR_API std::vector<percept_sample> predict_percept(const array& a, const stroke& s,
                                                                     const plan& p, const person& who = {});

/// Passes the same samples to `each`, in order, in the calling thread, each once its speed is known. Memory
/// does not grow with the length of the stroke.
/// \throws error as predict_percept(), before the first sample; for a tactor that the array does not have,
///         when the plan reaches it. Exceptions from `each` pass through.
TACTOR_API void follow_percept(const array& a, const stroke& s, const plan& p, const person& who,
                               const std::function<void(const percept_sample&)>& each);

/// Summarises samples. Errors and speed count only while something is felt. Standard deviations are those of
/// the population (divided by n). O(n log n) for n samples of a path that does not return to where it was.
[[nodiscard]] TACTOR_API percept_summary summarise(const std::vector<percept_sample>& samples);

/// Summarises all samples of predict_percept() without storing them.
/// \throws error as predict_percept().
[[nodiscard]] TACTOR_API percept_summary summarise(const array& a, const stroke& s, const plan& p,
                                                   const person& who = {});

/// Goldreich's observer (PLoS ONE 2007; Goldreich and Tong 2013). It localises taps with standard deviation
/// sigma_mm and expects speeds of 0 with standard deviation sigma_v_mm_s. It was built for taps on the
/// forearm, with a sigma of 10 mm; the default of 5 mm is assumed. There is no fit for the palm, or for
/// bursts that touch.
struct low_speed_observer {
    double sigma_mm = 5.0;       ///< least_sigma_mm to most_sigma_mm
    double sigma_v_mm_s = 100.0; ///< least_sigma_v_mm_s to most_sigma_v_mm_s

    friend bool operator==(const low_speed_observer&, const low_speed_observer&) = default;
};

inline constexpr double least_sigma_mm = 0.001;
inline constexpr double most_sigma_mm = 1000.0;
inline constexpr double least_sigma_v_mm_s = 0.001;
inline constexpr double most_sigma_v_mm_s = 1e6;

/// Returns a sentence about the model, its parameters and its purpose, to print with its numbers.
[[nodiscard]] TACTOR_API std::string describe(const low_speed_observer& o);

/// Returns the places where taps are felt. They begin at `onsets_s` (ascending). Each tap alone would be felt
/// at `alone`. The result is the x that minimises
/// sum |alone_i - x_i|^2 / sigma^2 + sum |x_(i+1) - x_i|^2 / (sigma_v (t_(i+1) - t_i))^2.
/// Taps at the same time are felt at one place. O(n), and exact to rounding. Any thread.
/// \throws error (bad_input) for parameters out of bounds, lists of different lengths, numbers that are not
///         finite, and onsets that do not ascend.
[[nodiscard]] TACTOR_API std::vector<point>
felt_places(const low_speed_observer& o, std::span<const double> onsets_s, std::span<const point> alone);

/// A burst as a tap.
struct tap {
    double onset_s = 0.0;
    point target = {}; ///< the target's place at the onset
    point alone = {};  ///< centre of energy of the burst's drives: the place where it is felt alone
    point felt = {};

    friend bool operator==(const tap&, const tap&) = default;
};

/// Distance of the prediction from the target, at the bursts.
struct tap_summary {
    std::optional<double> rms_error_mm = {};     ///< none without taps
    std::optional<double> largest_error_mm = {}; ///< none without taps
    double felt_length_mm = 0.0;                 ///< length of the chain of felt places
    double target_length_mm = 0.0;               ///< length of the chain of target places
    /// felt_length_mm / target_length_mm; none if the target rests.
    std::optional<double> length_ratio = {};
};

/// Predicts where the observer feels a plan's bursts. Bursts without drives are not felt. `p` must be a plan
/// of `s` on `a`. `who`: the person who feels them, if not the one for whom the plan was made. O(n log m) in
/// n bursts and the m points of the stroke.
/// \throws error (bad_input) as felt_places() does, for a continuous plan, for which the observer has no
///         prediction, for a plan that names a tactor that the array does not have, and as predict_percept()
///         does for a person.
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

/// Computes the places at which taps must be played to be felt at x: m = (I + K) x. If some m_i lies outside
/// the array, the result is the m in its hull that minimises sum |x(m) - x|^2. This convex problem is solved
/// until the sum changes by less than 1e-12 of itself in ten steps. Where the minimum is flat, as with strong
/// links, the m of another solver may differ though they are felt at the same places. O(n) in taps if
/// all fit; else some 50 to 2000 such steps, at most 5000, and ten million divided by n for long chains. Any
/// thread.
/// \throws error (bad_input) as felt_places() does, for taps that begin together or nearly so for the
///         observer (k of ten million and more), and for more than a million taps.
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
/// at its own point, which holds for phantom_kind::barycentric. With other phantoms, the distance from that
/// point to the centre of energy adds to the error. The plan warns that its bursts are moved, and names the
/// remaining error.
/// \throws error (bad_input) as make_plan() and compensate() do, and for `continuous`.
[[nodiscard]] TACTOR_API compensated_plan make_compensated_plan(const array& a, const layout& l,
                                                                const stroke& s, const plan_options& o,
                                                                const low_speed_observer& m = {});

} // namespace v0
} // namespace tactor
