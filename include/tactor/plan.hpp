// SPDX-License-Identifier: MIT
/// \file
/// Planning: from an array and a stroke to a plan, which says when each tactor plays. All functions are pure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/choices.hpp>
#include <tactor/path.hpp>
#include <tactor/phantom.hpp>
#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

namespace tactor {
inline namespace v0 {

/// Timing law SOA = slope * duration + intercept: Eq. (1) of Park et al. 2016, from Israr and Poupyrev 2011.
/// Both numbers depend on the body site.
struct timing_profile {
    double slope = 0.32;
    double intercept_s = 0.0473;
    double max_soa_s = 0.07; ///< Eq. (11), as the paper rounds it: intercept / (1 - slope)
};

/// Map from the requested intensity to an amplitude. Without level_db, 0 stays 0 and 1 stays 1.
struct intensity_scale {
    scale_kind kind = scale_kind::linear;
    /// stevens: exponent of Stevens's law, 0.1 to 3. The felt strength is amplitude^exponent, so the
    /// amplitude is intensity^(1 / exponent). On the finger the exponent is 0.95 at 60 Hz and 0.6 at 250 Hz
    /// (Stevens, Perception & Psychophysics 3, 1968).
    double exponent = 0.6;
    double sl_db = 0.0; ///< sl: sensation level of intensity 1, dB, above 0
    /// Level that is added to the amplitudes, dB, 0 or less. If it is below 0, intensity 1 has an amplitude
    /// below 1. The level of a single stroke (stroke_choices) is added to this level.
    double level_db = 0.0;

    /// Returns the amplitude of an intensity.
    /// \throws error (bad_input) for values out of range.
    [[nodiscard]] TACTOR_API double amplitude(double intensity) const;

    friend bool operator==(const intensity_scale&, const intensity_scale&) = default;
};

/// Options of a plan.
struct plan_options {
    algorithm_kind algorithm = algorithm_kind::park2016;
    phantom_kind phantom = phantom_kind::inverse_distance;
    /// `nearest` works only with phantom_kind::inverse_distance. The plan then warns if a point lies outside
    /// the triangle of its three tactors. Tactile Brush plays on grid lines, ignores this option and warns of
    /// that.
    faces_kind faces = faces_kind::delaunay;
    /// Custom model instead of `phantom`. The plan keeps the model as long as it needs drives from the model.
    std::shared_ptr<const phantom_model> custom_phantom = {};
    timing_profile profile = {};
    /// SOA: above the intercept, at most max_soa_s (10 s with burst_s). With `fit`, the longest SOA.
    double soa_s = 0.07;
    /// Duration of each burst of park2016, 0.0001 s to soa_s, instead of the duration by the timing law. The
    /// plan warns if SOA and duration do not follow the law. The other algorithms warn that they do not use
    /// this option.
    std::optional<double> burst_s = {};
    timing_kind timing = timing_kind::fixed;
    double min_duration_s = 0.020; ///< shortest burst that `fit` may use
    outside_kind outside = outside_kind::error;
    bool snap = false;        ///< Tactile Brush: move a start or end onto the grid
    bool drop_points = false; ///< Tactile Brush: drop crossings until the timing is possible
    overlap_kind overlap = overlap_kind::energy;
    double carrier_hz = 250.0;
    waveform wave = {};
    modulation am = {};
    intensity_scale scale = {};
};

/// Tactors that sound together from `onset_s` for `duration_s`.
struct burst {
    double onset_s = 0.0;
    double duration_s = 0.0;
    point position = {};
    double intensity = 1.0;           ///< A_v, as plan_options::scale gives it
    std::optional<double> tau_s = {}; ///< Tactile Brush: time at which the target is at `position`
    std::vector<drive> drives = {};   ///< in order of tactor

    friend bool operator==(const burst&, const burst&) = default;
};

/// Overlap of two or more bursts on one tactor.
struct conflict {
    unsigned tactor = 0;
    double from_s = 0.0;
    double to_s = 0.0;

    friend bool operator==(const conflict&, const conflict&) = default;
};

/// Carrier frequency from t_s until the next point. Between the times of both points, u goes from 0 to 1.
/// `next` is the frequency of the next point. Then the frequency is
///
///     hz + u (next - hz) + u (1 - u) (bend[0] + bend[1] u + bend[2] u^2 + bend[3] u^3)
struct carrier_point {
    double t_s = 0.0;                ///< from the start of the carrier
    double hz = 0.0;                 ///< >= 0
    std::array<double, 4> bend = {}; ///< Hz; zeros: linear

    friend bool operator==(const carrier_point&, const carrier_point&) = default;
};

/// Interval, s, at which `continuous` evaluates the phantom. Values between are interpolated linearly.
inline constexpr double continuous_step_s = 0.001;

/// Samples of a continuous stroke by column, in order of time. A plain value.
struct curve_samples {
    std::vector<point> positions = {};
    std::vector<double> intensities = {}; ///< A_v, as plan_options::scale gives it
    std::vector<std::size_t> ends = {};   ///< for each sample: number of `drives` up to its last one
    std::vector<drive> drives = {};       ///< each sample's drives in order of tactor

    /// Appends position, intensity and drives of `b`.
    TACTOR_API void add(const burst& b);

    friend bool operator==(const curve_samples&, const curve_samples&) = default;
};

/// Position, intensity and drives of a continuous stroke, every continuous_step_s and at its end. Values
/// between are interpolated linearly. A value: two curves are equal if all their samples are equal. Copies
/// and moves share the samples, so a moved-from curve keeps its value. Any thread. With a phantom model of
/// the library, the curve computes a sample when it is read, so an hour needs no more memory than a second.
class TACTOR_API curve {
public:
    /// Makes a curve of ceil(duration_s / continuous_step_s) + 1 samples.
    /// \throws error (bad_input) for a duration that is not above 0 or is longer than a day, for a wrong
    ///         number of samples, for drives that are not in order of tactor, and for numbers that are not
    ///         finite.
    curve(double duration_s, curve_samples samples);
    curve(const curve&) noexcept = default;
    curve& operator=(const curve&) noexcept = default;

    [[nodiscard]] double duration_s() const noexcept;
    /// Returns the number of samples.
    [[nodiscard]] std::uint64_t size() const noexcept;
    /// Returns the time of sample k: k steps, at most the duration.
    [[nodiscard]] double time_s(std::uint64_t k) const noexcept;

    /// Replaces `out` by sample k as a burst without duration, or by the last sample if k is size() or more.
    void sample(std::uint64_t k, burst& out) const;
    /// Replaces `out` by the values at a time, which is clamped to 0 ... duration_s. Interpolates linearly
    /// between the neighbouring samples.
    void at(double t_s, burst& out) const;

    friend TACTOR_API bool operator==(const curve& a, const curve& b);

    struct impl;

private:
    friend struct curve_access;
    explicit curve(std::shared_ptr<const impl> p) noexcept : impl_(std::move(p)) {}

    std::shared_ptr<const impl> impl_;
};

/// Drives of the tactors over time: bursts or a curve. A value: the same input gives the same plan. A program
/// can compare, store and rebuild plans.
struct plan {
    std::string algorithm = {}; ///< name of the planner: an algorithm_kind or another name
    std::string phantom = {};
    faces_kind faces = faces_kind::delaunay;
    double stroke_duration_s = 0.0;
    double stroke_length_mm = 0.0;
    double carrier_hz = 250.0;
    overlap_kind overlap = overlap_kind::energy;
    std::optional<double> soa_s = {};        ///< none if bursts have no common SOA
    double total_s = 0.0;                    ///< end of the last sound
    std::vector<burst> bursts = {};          ///< by onset; empty for `continuous`
    std::optional<tactor::curve> curve = {}; ///< `continuous` only
    std::vector<conflict> conflicts = {};
    std::vector<meeting> dropped = {};
    std::vector<std::string> warnings = {};
    waveform wave = {};
    modulation am = {};
    /// Carrier frequency over time, in order of time. Empty: carrier_hz throughout. For a recording along the
    /// path, the frequency is the rate at which the recording repeats.
    std::vector<carrier_point> course = {};

    friend bool operator==(const plan&, const plan&) = default;
};

/// Plans one stroke on an array. `l` must be the layout of `a`. The stroke's own choices (stroke::choices)
/// override `o`. A stroke with a stroke::fit is fitted first. Each burst takes O(log n) for n tactors.
/// \throws error (bad_input) for an SOA out of bounds, for a path that leaves the array (the message names
///         the place), for timing that is not possible (the message names the nearest possible duration), and
///         for Tactile Brush on an array that is not a grid.
[[nodiscard]] TACTOR_API plan make_plan(const array& a, const layout& l, const stroke& s,
                                        const plan_options& o);

/// Plans one stroke in the same way, and builds the layout itself.
[[nodiscard]] TACTOR_API plan make_plan(const array& a, const stroke& s, const plan_options& o = {});

/// Returns the burst duration for an SOA: min((SOA - intercept) / slope, SOA).
/// \throws error (bad_input) unless intercept < soa <= max_soa; the message names both bounds.
[[nodiscard]] TACTOR_API double burst_duration_s(const timing_profile& p, double soa_s);

/// Returns the duration of park2016's bursts: burst_s if it is set, else the duration by the timing law.
/// \throws error (bad_input) as the function above does, and for a burst that is longer than the SOA or
///         shorter than 0.1 ms.
[[nodiscard]] TACTOR_API double burst_duration_s(const plan_options& o);

} // namespace v0
} // namespace tactor
